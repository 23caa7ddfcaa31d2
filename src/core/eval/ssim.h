#pragma once
#include "eval/judge.h"

namespace radiafit {

/// The structural similarity of a render and its photograph.
SsimSum ssim(const JudgedView& view);

}  // namespace radiafit
