#include "eval/metrics.h"

#include <cmath>

namespace radiafit {

void ErrorSums::add(double difference) {
    ++values;
    if (!std::isfinite(difference)) {
        ++not_finite;
        difference = NAN;  // an infinite difference is a failure too, not a very low PSNR
    }
    absolute += std::abs(difference);
    squared += difference * difference;
}

void ErrorSums::add(const ErrorSums& other) {
    absolute += other.absolute;
    squared += other.squared;
    values += other.values;
    not_finite += other.not_finite;
}

double ErrorSums::ape() const { return 255 * absolute / double(values); }

double ErrorSums::psnr() const { return -10 * std::log10(squared / double(values)); }

}  // namespace radiafit
