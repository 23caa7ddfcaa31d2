#pragma once
#include "eval/judge.h"

namespace radiafit {

/// Of a render and its photograph.
SsimSum ssim(const JudgedView& view);

}  // namespace radiafit
