#pragma once
#include <cstring>

#include "base/parallel.h"
#include "cpu/lane_engine.h"

/// The definitions of LaneEngine: for the files that instantiate it.
namespace radiafit {

namespace detail {
/// term(begin) + ... + term(end - 1), by four sums that don't wait for one another.
template <class V, class Term>
V sum_of(size_t begin, size_t end, const Term& term) {
    V sum[4] = {};
    size_t i = begin;
    for (; i + 4 <= end; i += 4)
        for (size_t k = 0; k < 4; ++k) sum[k] += term(i + k);
    for (; i < end; ++i) sum[0] += term(i);
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}
}  // namespace detail

template <class Problem>
template <class Body>
void LaneEngine<Problem>::for_blocks(Life least, const Body& body) {
    const auto one = [&](size_t b, int) {
        if (life_[b] >= least) body(b);
    };
    if (life_.size() < 4)  // of the two-step solver, which has a thread for each
        for (size_t b = 0; b < life_.size(); ++b) one(b, 0);
    else
        parallel_for(life_.size(), 8, one);
}

template <class Problem>
void LaneEngine<Problem>::set_life(size_t block) {
    life_[block] = Life::over;
    for (size_t lane = 0; lane < lanes_of(block); ++lane) {
        const auto& s = states_[block][lane].problem;
        const bool active = s.status == Real(Status::active);
        life_[block] = std::max(life_[block], active ? Life::active : s.accepted != 0 ? Life::ended : Life::over);
    }
}

template <class Problem>
auto LaneEngine<Problem>::number_of(size_t block, int number) const -> V {
    if (number >= number::first_product) return products(block)[number - number::first_product];
    V out{};
    for (size_t lane = 0; lane < lanes_of(block); ++lane) {
        const auto* fields = reinterpret_cast<const char*>(&states_[block][lane].problem);
        Real x;
        if (number < number::first_own)
            std::memcpy(&x, fields + size_t(number) * sizeof x, sizeof x);
        else
            x = own_[(block * size_t(lanes) + lane) * size_t(room_.numbers) + size_t(number - number::first_own)];
        set_lane(out, int(lane), x);
    }
    return out;
}

template <class Problem>
void LaneEngine<Problem>::reset(std::span<const float> start) {
    using real = Real;  // of the constants in the shared text
    const size_t blocks = problem_->block_count();
    for (auto& vector : vectors_) vector.assign(problem_->begin(blocks), V{});
    problem_->set(start, vectors_[vector::trial].data());
    vectors_[vector::p] = vectors_[vector::trial];  // what a problem without samples returns
    states_.assign(blocks, {});
    life_.assign(blocks, Life::over);
    for (size_t b = 0; b < blocks; ++b) {
        for (size_t lane = 0; lane < lanes_of(b); ++lane) {
            auto& s = states_[b][lane].problem;
            s.error = HUGE_ERROR;
            s.step_factor = 1;
            s.status = Real(problem_->first_status(b * size_t(lanes) + lane));
        }
        set_life(b);
    }
}

template <class Problem>
void LaneEngine<Problem>::make_room(const Room& room) {
    room_ = room;
    const size_t blocks = problem_->block_count();
    vectors_.resize(size_t(room.vector_count()));
    for (size_t i = vector::first_own; i < vectors_.size(); ++i) vectors_[i].assign(problem_->begin(blocks), V{});
    products_.assign(blocks * size_t(room.product_count()), V{});
    own_.assign(blocks * size_t(lanes * room.numbers), Real(0));
}

template <class Problem>
void LaneEngine<Problem>::gradient_pass(bool diagonal) {
    for_blocks(Life::active, [&](size_t b) {
        const size_t begin = problem_->begin(b);
        double errors[lanes];
        problem_->direction(b, &vectors_[vector::trial][begin], &vectors_[vector::trial_g][begin],
                            diagonal ? &vectors_[vector::fresh][begin] : nullptr, errors);
        for (size_t lane = 0; lane < lanes_of(b); ++lane) states_[b][lane].trial_error = Real(errors[lane]);
    });
}

template <class Problem>
void LaneEngine<Problem>::directional_pass() {
    for_blocks(Life::active, [&](size_t b) {
        const size_t begin = problem_->begin(b);
        typename Problem::Sums sums;
        problem_->line(b, &vectors_[vector::p][begin], &vectors_[vector::d][begin], sums);
        for (int lane = 0; lane < int(lanes_of(b)); ++lane)
            states_[b][size_t(lane)].sums = {Real(sums.gauss_newton[lane]), Real(sums.curvature[lane]),
                                             Real(sums.third[lane]), Real(sums.fourth[lane])};
    });
}

template <class Problem>
void LaneEngine<Problem>::dot(std::initializer_list<DotProduct> products) {
    for_blocks(Life::active, [&](size_t b) {
        for (const DotProduct& product : products) {
            const V *x = vectors_[size_t(product.a)].data(), *y = vectors_[size_t(product.b)].data();
            const size_t begin = problem_->begin(b), end = problem_->begin(b + 1);
            V& into = products_[b * size_t(room_.product_count()) + size_t(product.into)];
            if (product.weight == vector::none) {
                into = detail::sum_of<V>(begin, end, [&](size_t i) { return x[i] * y[i]; });
            } else {
                const V* weight = vectors_[size_t(product.weight)].data();
                into = detail::sum_of<V>(begin, end, [&](size_t i) { return x[i] / weight[i] * y[i]; });
            }
        }
    });
}

template <class Problem>
template <class Function>
void LaneEngine<Problem>::step_by(const Function& function, const Turn& turn) {
    const typename Text::Turn here{turn.rule,     turn.restart,
                                   turn.slot,     {turn.stop.residual, turn.stop.output_change},
                                   turn.left_out, turn.first_step};
    for_blocks(Life::ended, [&](size_t b) {
        for (size_t lane = 0; lane < lanes_of(b); ++lane) {
            State& s = states_[b][lane];
            typename Text::Own own{};
            std::copy_n(this->own(b, lane), room_.numbers, own.x);
            typename Text::Given given{Real(problem_->texels(b)), s.trial_error, s.sums, {}};
            const V* products = this->products(b);
            for (int i = 0; i < std::min<int>(std::size(given.products), room_.product_count()); ++i)
                given.products[i] = products[i][int(lane)];
            function(s.problem, own, given, here);
            std::copy_n(own.x, room_.numbers, this->own(b, lane));
        }
        set_life(b);
    });
}

template <class Problem>
void LaneEngine<Problem>::step(Step which, const Turn& turn) {
    switch (which) {
#define RADIAFIT_CASE(file, function) \
    case Step::function:              \
        return step_by([](auto&... all) { Text::function(all...); }, turn);
        RADIAFIT_STEPS(RADIAFIT_CASE)
#undef RADIAFIT_CASE
    }
}

template <class Problem>
template <int count, int written, class Function>
void LaneEngine<Problem>::update_by(const Function& function, std::initializer_list<int> vectors,
                                    std::initializer_list<int> numbers, std::initializer_list<float> constants) {
    V* x[count];
    for (int k = 0; k < count; ++k) x[k] = vectors_[size_t(std::data(vectors)[k])].data();
    typename Text::Constants told{};
    std::copy(constants.begin(), constants.end(), told.x);
    for_blocks(Life::ended, [&](size_t b) {
        typename Text::Registers problem{};
        for (size_t k = 0; k < numbers.size(); ++k) problem.x[k] = number_of(b, std::data(numbers)[k]);
        for (size_t i = problem_->begin(b); i < problem_->begin(b + 1); ++i) {
            typename Text::Elements e;
            for (int k = 0; k < count; ++k) e.x[k] = x[k][i];
            function(e, problem, told);
            for (int k = 0; k < written; ++k) x[k][i] = e.x[k];
        }
    });
}

template <class Problem>
void LaneEngine<Problem>::update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                                 std::initializer_list<float> constants) {
    switch (which) {
#define RADIAFIT_CASE(file, function, count, written, ...) \
    case Update::function:                                 \
        return update_by<count, written>([](auto&... all) { Text::function(all...); }, vectors, numbers, constants);
        RADIAFIT_UPDATES(RADIAFIT_CASE)
#undef RADIAFIT_CASE
    }
}

template <class Problem>
EngineSummary LaneEngine<Problem>::summary() const {
    using real = Real;
    EngineSummary sum;
    for (size_t i = 0; i < problem_count(); ++i) {
        const auto& s = states_[i / size_t(lanes)][i % size_t(lanes)].problem;
        sum.active += s.status == Real(Status::active);
        sum.accepted += s.accepted != 0;
        if (s.error < HUGE_ERROR) sum.error += double(s.error);  // else never evaluated, or not finite
    }
    return sum;
}

template <class Problem>
void LaneEngine<Problem>::outcomes(std::span<ProblemOutcome> out) const {
    using real = Real;
    for (size_t i = 0; i < problem_count(); ++i) {
        const auto& s = states_[i / size_t(lanes)][i % size_t(lanes)].problem;
        out[i] = {s.error < HUGE_ERROR ? float(s.error) : 0, Status(int(s.status)), uint32_t(s.iterations)};
        if (out[i].status == Status::active) out[i].status = Status::max_iterations;
    }
}

template <class Problem>
void LaneEngine<Problem>::read_errors(std::span<float> out) const {
    for (size_t i = 0; i < problem_count(); ++i)
        out[i] = float(states_[i / size_t(lanes)][i % size_t(lanes)].problem.error);
}

}  // namespace radiafit
