#pragma once
#include <vector>

#include "reference/curve_rivals.h"

namespace radiafit::fits {

/// SciPy's least_squares by each of its methods, in an interpreter beside this program, which asks it for residuals and
/// derivatives. None where no python3 on PATH, nor Debian's, has SciPy.
std::vector<CurveRival> scipy_rivals();

}  // namespace radiafit::fits
