#include "rules.h"

namespace radiafit {

Judgement faster_than_cpu(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement distribution_share(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement streaming_share(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement lafortune_streaming(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement switching_share(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement utilization(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement memory_over_disk(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement combined_passes(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement cheap_penalties(const FinishedRun&) { return {.not_run = "no rule yet"}; }
Judgement paper_chip(const FinishedRun&) { return {.not_run = "no rule yet"}; }

}  // namespace radiafit
