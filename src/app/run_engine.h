#pragma once
#include <algorithm>

#include "app/solver.h"
#include "model/lfm_start.h"

namespace radiafit {

/// Starts, optimizes and reads back one engine. Terms are fitted together, or one after another with the earlier ones
/// frozen (deflation).
template <Engine E>
void run_engine(E& engine, const LfmLayout& layout, FitTask& task) {
    const FitRequest& request = task.request;
    const LfmOptions& options = task.options;
    FitOutcome& out = task.out;
    const ProblemStatistics statistics = engine.count();
    if (std::all_of(statistics.samples.begin(), statistics.samples.end(), [](uint32_t n) { return n == 0; }))
        reject_unseen(task.dataset);
    const OptimizerOptions optimizer = request.optimizer_options();
    const auto hook = [&](int iteration) {
        if (task.each_iteration)
            task.each_iteration(iteration, [&](std::span<float> errors) { engine.read_errors(errors); });
    };
    std::vector<float> parameters = lfm_start(layout, statistics.mean, request.seed);
    const int stages = request.deflate ? options.terms : 1;
    for (int stage = 0; stage < stages; ++stage) {
        if (request.deflate)
            engine.fit_terms(stage, stage + 1);
        else
            engine.fit_terms(0, options.terms);
        engine.reset(parameters);
        out.trace.append(optimize(engine, optimizer, hook));
        engine.read_parameters(parameters);
    }
    std::vector<ProblemOutcome> outcomes(engine.problem_count());
    engine.outcomes(outcomes);
    fill_outcomes(task, layout, statistics, outcomes, std::move(parameters));
}

}  // namespace radiafit
