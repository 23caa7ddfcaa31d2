#include "rules.h"

namespace radiafit {

Judgement memory_linear(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement gather_and_scatter(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement pixels_and_texels(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement cost_linear(const FinishedRun&) { return {.not_run = "no rule yet"}; }

}  // namespace radiafit
