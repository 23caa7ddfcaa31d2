#pragma once
#include <span>

#include "finished_run.h"
#include "judgement.h"

/// The paper's claims, and for each the rule that judges it from the rows of one run. A rule throws UserError for rows
/// that lack what it needs.
namespace radiafit::harness {

// How fast, and to which ends, optimizers converge: convergence.cpp.
Judgement iteration_ratio(const FinishedRun& run);
Judgement better_minimum(const FinishedRun& run);
Judgement idle_before_arrival(const FinishedRun& run);
Judgement newton_rate(const FinishedRun& run);
Judgement consistent_ratio(const FinishedRun& run);

// How good the pictures are: images.cpp.
Judgement above_pca(const FinishedRun& run);
Judgement half_as_good(const FinishedRun& run);
Judgement resolution_matters(const FinishedRun& run);

// Where the time goes: time.cpp.
Judgement faster_than_cpu(const FinishedRun& run);
Judgement distribution_share(const FinishedRun& run);
Judgement streaming_share(const FinishedRun& run);
Judgement lafortune_streaming(const FinishedRun& run);
Judgement switching_share(const FinishedRun& run);
Judgement memory_over_disk(const FinishedRun& run);
Judgement combined_passes(const FinishedRun& run);

// What the fragment stage does with it: utilization.cpp.
Judgement utilization(const FinishedRun& run);
Judgement cheap_penalties(const FinishedRun& run);
Judgement paper_chip(const FinishedRun& run);

// How time and memory grow: scale.cpp.
Judgement redistribution(const FinishedRun& run);
Judgement memory_linear(const FinishedRun& run);
Judgement gather_and_scatter(const FinishedRun& run);
Judgement pixels_and_texels(const FinishedRun& run);
Judgement cost_linear(const FinishedRun& run);

struct Claim {
    const char *id, *section, *states, *rule;
    const char* experiment;  ///< whose rows it is judged from
    Judgement (*judge)(const FinishedRun& run);
};
std::span<const Claim> claims();

}  // namespace radiafit::harness
