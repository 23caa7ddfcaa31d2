#pragma once
#include <string>
#include <vector>

#include "eval/judge.h"

namespace radiafit {

/// Images that the fit misses by far more than the others: another object, a lamp that failed, a camera in the wrong
/// place. The logarithm of their mean squared error is above the median by more than five standard deviations, which
/// are 1.4826 times the median distance to the median (Rousseeuw and Croux 1993), and by more than that of 3. Names, in
/// dataset order; none of fewer than five images.
std::vector<std::string> outlying_images(const JudgeResult& judged);

}  // namespace radiafit
