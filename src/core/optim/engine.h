#pragma once
#include <algorithm>
#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include "optim/methods.h"

namespace radiafit {

/// What one streaming pass finds out about the problems before they start.
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

/// What an optimizer calls. Vectors, problems' numbers and sums live on the device; verbs are ordered, and only those
/// marked * wait for the device. Nothing is allocated after make_room(). Every verb applies to all problems at once;
/// steps leave problems that have stopped as they are.
///
///   count() *                  statistics; fixes S-bar, lambda_view and which problems have no samples
///   reset(start)               trial = start [N, Parameters order]; states fresh; p undefined until the first accept
///   make_room(room)            the optimizer's private vectors and numbers, all zero
///   fit_terms(first, last)     terms outside [first, last) stay as they are: their gradient is zero (deflation)
///   gradient_pass(diagonal)    at trial: E_t and its gradient, penalties included; on request also the fresh
///                              P = diag(J'J)/S-bar + 20 lambda, floored at 1e-4 of the problem's largest entry
///   directional_pass()         at p along d: LineSums, penalties included
///   dot(products)              each a number of every problem
///   step(which, turn)          the text of that name for each problem
///   update(which, vectors, numbers, constants)   the text of that name for each element of these vectors
///   summary() *, outcomes(out) *, read_errors(out) *, read_parameters(out) *
template <class E>
concept Engine = requires(E& e, std::span<const float> start, std::span<float> out, std::span<ProblemOutcome> outcomes,
                          Room room, bool flag, std::initializer_list<DotProduct> products, Step step, Turn turn,
                          Update update, std::initializer_list<int> list, std::initializer_list<float> constants) {
    { e.problem_count() } -> std::convertible_to<size_t>;  ///< problems times channels: M
    { e.count() } -> std::convertible_to<ProblemStatistics>;
    e.reset(start);
    e.make_room(room);
    e.fit_terms(0, 1);
    e.gradient_pass(flag);
    e.directional_pass();
    e.dot(products);
    e.step(step, turn);
    e.update(update, list, list, constants);
    { e.summary() } -> std::convertible_to<EngineSummary>;
    e.outcomes(outcomes);    ///< [M]
    e.read_errors(out);      ///< [M] accepted E_t
    e.read_parameters(out);  ///< [N] Parameters order
};

}  // namespace radiafit
