#pragma once
#include "base/rng.h"

namespace radiafit::testing {

/// Of mean 0 and standard deviation 1, nearly: the sum of twelve uniform numbers.
inline double gauss(Rng& rng) {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += double(rng.uniform());
    return sum;
}

}  // namespace radiafit::testing
