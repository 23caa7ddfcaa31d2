#pragma once
#include <algorithm>
#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include "optim/problem_text.h"

namespace radiafit {

/// What one streaming pass tells about the problems before they start.
struct ProblemStatistics {
    std::vector<uint32_t> samples;  ///< [problems] pixels in the problem's texels (one pixel = three residuals)
    std::vector<float> mean;        ///< [problems][3] mean of the target the problem fits (light field map: of L t)
    /// Whether some problem has a sample.
    bool any() const {
        return std::any_of(samples.begin(), samples.end(), [](uint32_t n) { return n > 0; });
    }
};

/// What is left of a problem when the optimizer stops; a vertex (or texel) has one per channel of its state.
struct ProblemOutcome {
    float error = 0;  ///< E_t at the returned parameters, normalized by S/texels
    Status status = Status::active;
    uint32_t iterations = 0;
};

struct EngineSummary {
    double error = 0;       ///< sum of E_t over all problems that have samples
    uint64_t active = 0;    ///< problems still running
    uint64_t accepted = 0;  ///< problems whose last trial was accepted
};

/// Engine verbs, in the order the optimizer calls them. Vectors (p, trial, d, g, trial gradient, P), sums and states
/// live on the device; verbs are ordered, and only those marked * wait for the device. Nothing is allocated after
/// reset(). Every verb applies to all problems at once; stopped problems keep p and have step 0.
///
///   count() *                  statistics; fixes S-bar, lambda_view and which problems have no samples
///   reset(start)               trial = start [N, Parameters order]; states fresh; p undefined until the first accept
///   fit_terms(first, last)     terms outside [first, last) stay as they are: their gradient is zero (deflation)
///   direction_pass(diagonal)   at trial: E_t and its gradient, penalties included; on request also the fresh
///                              P = diag(J'J)/S-bar + 20 lambda, floored at 1e-4 of the problem's largest entry
///   project(rule, fresh)       z'.g', z'.g, d.g' per problem, z = g/P for cg_modern (P the fresh one if told), else g
///   after_direction(rule, restart, stop)   the text of that name for each problem
///   update_direction(rule, fresh)  where accepted: p <- trial, g <- trial gradient, P <- fresh P; d <- -z + beta d
///   line_pass()                at p along d: LineSums, penalties included
///   after_line(rule, stop)     the text of that name for each problem
///   advance()                  trial <- p + trial_step d
///   summary() *, outcomes(out) *, read_errors(out) *, read_parameters(out) *
template <class E>
concept Engine = requires(E& e, std::span<const float> start, std::span<float> out, std::span<ProblemOutcome> outcomes,
                          Rule rule, bool flag, ProblemText<float>::StopRules stop) {
    { e.problem_count() } -> std::convertible_to<size_t>;  ///< problems times channels: M
    { e.count() } -> std::convertible_to<ProblemStatistics>;
    e.reset(start);
    e.fit_terms(0, 1);
    e.direction_pass(flag);
    e.project(rule, flag);
    e.after_direction(rule, flag, stop);
    e.update_direction(rule, flag);
    e.line_pass();
    e.after_line(rule, stop);
    e.advance();
    { e.summary() } -> std::convertible_to<EngineSummary>;
    e.outcomes(outcomes);    ///< [M]
    e.read_errors(out);      ///< [M] accepted E_t
    e.read_parameters(out);  ///< [N] Parameters order
};

}  // namespace radiafit
