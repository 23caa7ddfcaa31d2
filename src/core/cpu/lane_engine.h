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

/// The CPU's Engine: all cores, one block at a time. A block is as many problems as are side by side in lanes: a
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
    void make_room(const Room& room);
    void gradient_pass(bool diagonal);
    void directional_pass();
    void dot(std::initializer_list<DotProduct> products);
    void step(Step which, const Turn& turn);
    void update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                std::initializer_list<float> constants);
    /// update() by the caller's function of `count` vectors, the first `written` of which it changes:
    /// function(elements, numbers of their problem, constants). Include cpu/lane_engine_impl.h.
    template <int count, int written, class Function>
    void update_by(const Function& function, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                   std::initializer_list<float> constants);
    EngineSummary summary() const;
    void outcomes(std::span<ProblemOutcome> out) const;
    void read_errors(std::span<float> out) const;
    void read_parameters(std::span<float> out) const { problem_->get(vectors_[vector::p].data(), out); }

    uint64_t bytes() const {  ///< of the vectors and states
        return bytes(vectors_[vector::p].size(), life_.size(), room_);
    }
    static uint64_t bytes(uint64_t length, uint64_t blocks, const Room& room) {
        return uint64_t(room.vector_count()) * length * sizeof(V) +
               blocks * (sizeof(States) + sizeof(Life) + uint64_t(room.product_count()) * sizeof(V) +
                         uint64_t(room.numbers * lanes) * sizeof(Real));
    }

private:
    using Text = ProblemText<Real, V>;
    struct State {
        typename Text::ProblemState problem;
        Real trial_error;
        typename Text::LineSums sums;
    };
    static_assert(sizeof(State::problem) == number::first_own * sizeof(Real), "its fields are numbered");
    using States = std::array<State, size_t(lanes)>;
    /// A block's state is that of its liveliest problem. One that ended in the last gradient pass may still have a
    /// trial to take over.
    enum class Life : uint8_t { over, ended, active };

    /// body(block) for the blocks whose state is `least` or livelier.
    template <class Body>
    void for_blocks(Life least, const Body& body);
    template <class Function>
    void step_by(const Function& function, const Turn& turn);
    void set_life(size_t block);
    size_t lanes_of(size_t block) const {
        return std::min(size_t(lanes), problem_->problem_count() - block * size_t(lanes));
    }
    /// A number of the block's problems, 0 beyond the last one.
    V number_of(size_t block, int number) const;
    Real* own(size_t block, size_t lane) {
        return own_.data() + (block * size_t(lanes) + lane) * size_t(room_.numbers);
    }
    const V* products(size_t block) const { return products_.data() + block * size_t(room_.product_count()); }

    Problem* problem_;
    Room room_;
    std::vector<States> states_;  ///< [blocks]
    std::vector<Life> life_;      ///< [blocks]
    std::vector<V> products_;     ///< [blocks][products]
    std::vector<Real> own_;       ///< [problems][numbers]
    std::vector<std::vector<V>> vectors_{size_t(vector::first_own)};
};

}  // namespace radiafit
