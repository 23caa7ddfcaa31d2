#pragma once
#include <array>
#include <span>
#include <vector>

#include "optim/engine.h"

namespace radiafit {

/// LineSums (shaders/optimize/problem_state.glsl) of a block.
template <class Lanes>
struct LineSumsOf {
    Lanes gauss_newton{}, curvature{}, third{}, fourth{};
};

/// The CPU's Engine: all cores, one block at a time. A block is as many problems as stand side by side in lanes: a
/// vertex's three, or eight texels. Its parameters are a range of V in every vector. Problems are independent, so
/// results depend neither on the number of threads nor, to the bit, on which problems share a block. Blocks whose
/// problems have all stopped are skipped.
///
/// Problem knows the samples and the objective over them:
///     Real, V             a scalar, and lanes of it (base/lanes.h or base/pack.h)
///     lanes               problems of a block
///     problem_count(), block_count()
///     begin(block)        where its range begins, in V; begin(block_count()) is a vector's length
///     count()             statistics of its problems; before everything below
///     first_status(problem)   active, or why it can't be fitted
///     texels(block)       of the surface, over which its errors are sums (ProblemText's `texels`)
///     set(values, V*), get(V*, values)    a whole vector from Parameters order and back
///     fit_terms(first, last)  see optim/engine.h
///     direction(block, x, gradient, diagonal or null, errors)     E_t, penalties included; errors [lanes]
///     Sums, line(block, x, d, sums)   penalties included; Sums is a LineSumsOf lanes of any scalar
template <class Problem>
class LaneEngine {
public:
    using Real = typename Problem::Real;
    using V = typename Problem::V;
    static constexpr int lanes = Problem::lanes;

    /// The problem must outlive the engine.
    explicit LaneEngine(Problem& problem) : problem_(&problem) {}

    size_t problem_count() const { return problem_->problem_count(); }
    ProblemStatistics count() { return problem_->count(); }
    void reset(std::span<const float> start);
    void fit_terms(int first, int last) { problem_->fit_terms(first, last); }
    void direction_pass(bool diagonal);
    void project(Rule rule, bool fresh);
    void after_direction(Rule rule, bool restart, ProblemText<float>::StopRules stop);
    void update_direction(Rule rule, bool fresh);
    void line_pass();
    void after_line(Rule rule, ProblemText<float>::StopRules stop);
    void advance();
    EngineSummary summary() const;
    void outcomes(std::span<ProblemOutcome> out) const;
    void read_errors(std::span<float> out) const;
    void read_parameters(std::span<float> out) const { problem_->get(p_.data(), out); }

    uint64_t bytes() const { return bytes(p_.size(), life_.size()); }  ///< of the vectors and states
    static uint64_t bytes(uint64_t length, uint64_t blocks) {
        return 7 * length * sizeof(V) + blocks * (sizeof(States) + sizeof(Life));
    }

private:
    using Text = ProblemText<Real>;
    struct State {
        typename Text::ProblemState problem;
        Real alpha, trial_error, trial_norm, cross, conjugate;
        typename Text::LineSums sums;
    };
    using States = std::array<State, size_t(lanes)>;
    /// Of a block: the liveliest of its problems. One that ended in the last pass A may still have a trial to take
    /// over.
    enum class Life : uint8_t { over, ended, active };

    /// body(block) for those that live so much or more.
    template <class Body>
    void for_blocks(Life least, const Body& body);
    /// body(state, block) for the problems of such blocks; then what the blocks live on as.
    template <class Body>
    void update_states(Life least, const Body& body);
    void set_life(size_t block);
    size_t lanes_of(size_t block) const {
        return std::min(size_t(lanes), problem_->problem_count() - block * size_t(lanes));
    }
    /// of(state) of each lane, 0 beyond the last problem.
    template <class Of>
    V gather(size_t block, const Of& of) const;

    Problem* problem_;
    std::vector<States> states_;  ///< [blocks]
    std::vector<Life> life_;      ///< [blocks]
    std::vector<V> p_, trial_, d_, g_, trial_g_, precondition_, fresh_;
};

}  // namespace radiafit
