#pragma once
#include <functional>

#include "base/clock.h"
#include "optim/engine.h"
#include "optim/trace.h"

namespace radiafit {

struct OptimizerOptions {
    Rule rule = Rule::cg_modern;
    int iterations = 25;           ///< Section 5.3.2 rule 3
    float stop_residual = 0;       ///< rule 1: root mean square residual, units of the targets; 0 = off
    float stop_output_change = 0;  ///< rule 2: root mean square change of the model's output; 0 = off
    /// Iterations between fresh preconditioners (cg_modern). Each restarts, and hard problems need long runs of
    /// conjugate directions: 10 takes the median vertex of the star four times as long to 1.01 of the least error.
    int refresh_every = 100;
    int first_refresh = 10;  ///< and once early: terms that start at zero tell nothing of their partners before
};

/// Steepest descent and conjugate gradients with an explicit d'Hd (Section 3), for all problems of an engine at once.
/// Each problem accepts, restarts, halves and stops by itself; the loop ends when none is active.
/// Row k of the trace holds the state after k trials, row 0 the start. Call engine.count() and engine.reset() before.
/// `each_iteration`, if given, is called after every row, outside the trace's clock.
template <Engine E>
Trace optimize(E& engine, const OptimizerOptions& options,
               const std::function<void(int iteration)>& each_iteration = {}) {
    const ProblemText<float>::StopRules stop{options.stop_residual, options.stop_output_change};
    const bool modern = options.rule == Rule::cg_modern;
    const bool descent = options.rule == Rule::steepest_descent;
    Trace trace;
    Stopwatch clock;
    double paused = 0;
    for (int k = 0;; ++k) {
        const bool fresh = modern && (k % options.refresh_every == 0 || k == options.first_refresh);
        engine.direction_pass(fresh);
        engine.project(options.rule, fresh);
        engine.after_direction(options.rule, fresh, stop);
        engine.update_direction(options.rule, fresh);
        const EngineSummary now = engine.summary();
        trace.rows.push_back({k, clock.wall_s() - paused, now.error, now.accepted, now.active});
        if (each_iteration) {
            const double before = clock.wall_s();
            each_iteration(k);
            paused += clock.wall_s() - before;
        }
        if (k >= options.iterations || now.active == 0) break;
        if (!descent || k == 0) {  // steepest descent keeps its first step, halved when the error rises
            engine.line_pass();
            engine.after_line(options.rule, stop);
        }
        engine.advance();
    }
    return trace;
}

/// The model's terms together, or with `deflate` one after another, the earlier ones frozen. Call engine.count()
/// before. p [N, Parameters order]: the start, and on return what the engine ended with.
template <Engine E>
Trace optimize_terms(E& engine, const OptimizerOptions& options, int terms, bool deflate, std::span<float> p,
                     const std::function<void(int iteration)>& each_iteration = {}) {
    Trace trace;
    const int together = deflate ? 1 : terms;
    for (int first = 0; first < terms; first += together) {
        engine.fit_terms(first, first + together);
        engine.reset(p);
        trace.append(optimize(engine, options, each_iteration));
        engine.read_parameters(p);
    }
    return trace;
}

}  // namespace radiafit
