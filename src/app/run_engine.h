#pragma once
#include <algorithm>

#include "app/solver.h"
#include "model/lfm_start.h"
#include "model/penalty.h"

namespace radiafit {

/// Throws UserError: no training view has a sample.
[[noreturn]] void reject_unseen(const Dataset& dataset);

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
    OptimizerOptions optimizer{.rule = request.rule(),
                               .iterations = request.iterations,
                               .stop_residual = float(request.stop_residual),
                               .stop_output_change = float(request.stop_output_change)};
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
        Trace trace = optimize(engine, optimizer, hook);
        const int before = out.trace.rows.empty() ? 0 : out.trace.rows.back().iteration;
        const double time = out.trace.rows.empty() ? 0 : out.trace.rows.back().time_s;
        for (TraceRow row : trace.rows) {
            row.iteration += before;
            row.time_s += time;
            out.trace.rows.push_back(row);
        }
        engine.read_parameters(parameters);
    }
    std::vector<ProblemOutcome> outcomes(engine.problem_count());
    engine.outcomes(outcomes);
    LightFieldFit& fit = out.fit;
    fit.parameters = std::move(parameters);
    for (auto* list : {&fit.iterations, &fit.samples}) list->resize(outcomes.size());
    fit.status.resize(outcomes.size());
    fit.error.resize(outcomes.size());
    for (size_t i = 0; i < outcomes.size(); ++i) {
        const size_t v = i / 3;
        fit.status[i] = outcomes[i].status;
        fit.iterations[i] = outcomes[i].iterations;
        fit.samples[i] = statistics.samples[v];
        if (!statistics.samples[v]) continue;
        // the engine's error is E / S-bar plus the penalties; problems.exr wants E itself
        const double penalty = penalty_error(layout, options, v, fit.parameters, {&statistics.mean[3 * v], 3})[i % 3];
        const double ring_texels = double(layout.view_offset(v) - layout.offset(v)) / double(layout.stride());
        fit.error[i] = float(std::max(0.0, outcomes[i].error - penalty) * statistics.samples[v] / ring_texels);
    }
}

}  // namespace radiafit
