#include "rules.h"

namespace radiafit {

Judgement iteration_ratio(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement better_minimum(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement idle_before_arrival(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement newton_rate(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement consistent_ratio(const FinishedRun&) { return {.not_run = "no rule yet"}; }

}  // namespace radiafit
