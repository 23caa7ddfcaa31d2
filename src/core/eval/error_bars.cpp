#include "eval/error_bars.h"

#include <cmath>

namespace radiafit {

void ErrorBarFigures::add(const ErrorBar& bar, const Vec3f& error, const float* stored) {
    for (int c = 0; c < 3; ++c) {
        ++values;
        within += std::abs(error[c]) <= std::hypot(bar.fit[c], bar.noise[c]);
        (bar.doubtful() ? doubtful : sound).add(double(stored[c]));
    }
}

void ErrorBarFigures::add(const ErrorBarFigures& other) {
    values += other.values;
    within += other.within;
    sound.add(other.sound);
    doubtful.add(other.doubtful);
}

double ErrorBarFigures::within_share() const { return values ? double(within) / double(values) : NAN; }

double ErrorBarFigures::doubtful_share() const { return values ? double(doubtful.values) / double(values) : NAN; }

}  // namespace radiafit
