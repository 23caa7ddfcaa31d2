#pragma once
#include <cmath>

#include "base/rings.h"

namespace radiafit::harness {

/// A sum in double, and the sum of its terms' magnitudes: what a rounding error may be measured against.
struct ExactSum {
    double value = 0, magnitude = 0;
    void add(double term) { add(term, std::abs(term)); }
    void add(double term, double size) { value += term, magnitude += size; }
    ExactSum& operator+=(const ExactSum& term) {
        add(term.value, term.magnitude);
        return *this;
    }
    friend ExactSum operator*(const ExactSum& a, const ExactSum& b) {
        return {a.value * b.value, a.magnitude * b.magnitude};
    }
};
inline ExactSum exact(double value) { return {value, std::abs(value)}; }

}  // namespace radiafit::harness
