#pragma once
#include "base/parallel.h"
#include "cpu/lane_engine.h"

/// The definitions of LaneEngine: for the files that instantiate it.
namespace radiafit {

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
template <class Body>
void LaneEngine<Problem>::update_states(Life least, const Body& body) {
    for_blocks(least, [&](size_t b) {
        for (size_t lane = 0; lane < lanes_of(b); ++lane) body(states_[b][lane], b);
        set_life(b);
    });
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
template <class Of>
auto LaneEngine<Problem>::gather(size_t block, const Of& of) const -> V {
    V out{};
    for (size_t lane = 0; lane < lanes_of(block); ++lane) set_lane(out, int(lane), of(states_[block][lane]));
    return out;
}

template <class Problem>
void LaneEngine<Problem>::reset(std::span<const float> start) {
    using real = Real;  // of the constants in the shared text
    const size_t blocks = problem_->block_count();
    for (auto* vector : {&p_, &trial_, &d_, &g_, &trial_g_, &precondition_, &fresh_})
        vector->assign(problem_->begin(blocks), V{});
    problem_->set(start, trial_.data());
    p_ = trial_;  // what a problem without samples returns
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
void LaneEngine<Problem>::direction_pass(bool diagonal) {
    for_blocks(Life::active, [&](size_t b) {
        const size_t begin = problem_->begin(b);
        double errors[lanes];
        problem_->direction(b, &trial_[begin], &trial_g_[begin], diagonal ? &fresh_[begin] : nullptr, errors);
        for (size_t lane = 0; lane < lanes_of(b); ++lane) states_[b][lane].trial_error = Real(errors[lane]);
    });
}

template <class Problem>
void LaneEngine<Problem>::project(Rule rule, bool fresh) {
    const V* weight = rule != Rule::cg_modern ? nullptr : fresh ? fresh_.data() : precondition_.data();
    for_blocks(Life::active, [&](size_t b) {
        V norm{}, cross{}, conjugate{};
        for (size_t i = problem_->begin(b); i < problem_->begin(b + 1); ++i) {
            const V z = weight ? trial_g_[i] / weight[i] : trial_g_[i];
            norm += z * trial_g_[i];
            cross += z * g_[i];
            conjugate += d_[i] * trial_g_[i];
        }
        for (size_t lane = 0; lane < lanes_of(b); ++lane) {
            State& s = states_[b][lane];
            s.trial_norm = norm[int(lane)];
            s.cross = cross[int(lane)];
            s.conjugate = conjugate[int(lane)];
        }
    });
}

template <class Problem>
void LaneEngine<Problem>::after_direction(Rule rule, bool restart, ProblemText<float>::StopRules stop) {
    update_states(Life::ended, [&](State& s, size_t b) {
        Text::after_direction(s.problem, int(rule), restart, s.alpha, Real(problem_->texels(b)),
                              {stop.residual, stop.output_change}, s.trial_error, s.trial_norm, s.cross, s.conjugate);
    });
}

template <class Problem>
void LaneEngine<Problem>::update_direction(Rule rule, bool fresh) {
    for_blocks(Life::ended, [&](size_t b) {
        const V accepted = gather(b, [](const State& s) { return s.problem.accepted; });
        const V beta = gather(b, [](const State& s) { return s.problem.beta; });
        for (size_t i = problem_->begin(b); i < problem_->begin(b + 1); ++i) {
            p_[i] = select_nonzero(accepted, trial_[i], p_[i]);
            g_[i] = select_nonzero(accepted, trial_g_[i], g_[i]);
            V z = g_[i];
            if (rule == Rule::cg_modern) {
                if (fresh) precondition_[i] = select_nonzero(accepted, fresh_[i], precondition_[i]);
                z = select_nonzero(precondition_[i], z / precondition_[i], z);
            }
            d_[i] = beta * d_[i] - z;
        }
    });
}

template <class Problem>
void LaneEngine<Problem>::line_pass() {
    for_blocks(Life::active, [&](size_t b) {
        const size_t begin = problem_->begin(b);
        typename Problem::Sums sums;
        problem_->line(b, &p_[begin], &d_[begin], sums);
        for (int lane = 0; lane < int(lanes_of(b)); ++lane)
            states_[b][size_t(lane)].sums = {Real(sums.gauss_newton[lane]), Real(sums.curvature[lane]),
                                             Real(sums.third[lane]), Real(sums.fourth[lane])};
    });
}

template <class Problem>
void LaneEngine<Problem>::after_line(Rule rule, ProblemText<float>::StopRules stop) {
    update_states(Life::active, [&](State& s, size_t b) {
        Text::after_line(s.problem, s.alpha, int(rule), Real(problem_->texels(b)), {stop.residual, stop.output_change},
                         s.sums);
    });
}

template <class Problem>
void LaneEngine<Problem>::advance() {
    for_blocks(Life::active, [&](size_t b) {
        const V step = gather(b, [](const State& s) { return Text::trial_step(s.problem, s.alpha); });
        for (size_t i = problem_->begin(b); i < problem_->begin(b + 1); ++i) trial_[i] = p_[i] + step * d_[i];
    });
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
