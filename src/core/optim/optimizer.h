#pragma once
#include <functional>

#include "base/clock.h"
#include "base/interrupt.h"
#include "optim/engine.h"
#include "optim/trace.h"

namespace radiafit {

/// Any optimizer: a schedule of with_schedule(), or another. Each problem accepts, restarts, halves and stops by
/// itself; the loop ends when none is active. Row k of the trace holds the state after k trials, row 0 the start. Call
/// engine.count() and engine.reset() before. `each_iteration`, if given, is called after every row, outside the trace's
/// clock.
template <Engine E, class Schedule>
requires requires(const Schedule& s) {
    { s.room() } -> std::same_as<Room>;
}
Trace optimize(E& engine, const Schedule& schedule, int iterations,
               const std::function<void(int iteration)>& each_iteration = {}) {
    engine.make_room(schedule.room());
    Trace trace;
    Stopwatch clock;
    double paused = 0;
    for (int k = 0;; ++k) {
        schedule.judge(engine, k);
        const EngineSummary now = engine.summary();
        trace.rows.push_back({k, clock.wall_s() - paused, now.error, now.accepted, now.active});
        if (each_iteration) {
            const double before = clock.wall_s();
            each_iteration(k);
            paused += clock.wall_s() - before;
        }
        if (k >= iterations || now.active == 0) return trace;
        throw_if_interrupted();
        schedule.move(engine, k);
    }
}

/// The same by an optimizer of optim/methods.h.
template <Engine E>
Trace optimize(E& engine, const OptimizerOptions& options,
               const std::function<void(int iteration)>& each_iteration = {}) {
    return with_schedule(
        options, [&](const auto& schedule) { return optimize(engine, schedule, options.iterations, each_iteration); });
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
