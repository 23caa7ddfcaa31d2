#pragma once
#include "base/flush_subnormals.h"
#include "base/parallel.h"
#include "cpu/texel_engine.h"
#include "cpu/texel_sums.h"

/// The definitions of TexelEngine: for the files that instantiate it.
namespace radiafit {

template <class Text>
template <class Body>
void TexelEngine<Text>::for_batches(Life least, const Body& body) {
    const auto one = [&](size_t b, int) {
        if (life_[b] >= least) body(b);
    };
    if (batches_.size() < 4)  // a problem of the two-step solver
        for (size_t b = 0; b < batches_.size(); ++b) one(b, 0);
    else
        parallel_for(batches_.size(), 16, one);
}

template <class Text>
template <class Body>
void TexelEngine<Text>::update_states(Life least, const Body& body) {
    for_batches(least, [&](size_t b) {
        scatter(b, [&](State& s, int) { body(s); });
        set_life(b);
    });
}

template <class Text>
void TexelEngine<Text>::set_life(size_t batch) {
    Life life = Life::over;
    scatter(batch, [&](const State& s, int) {
        life = std::max(life, s.active() ? Life::active : s.state.accepted != 0 ? Life::ended : Life::over);
    });
    life_[batch] = life;
}

template <class Text>
template <class Of>
Pack TexelEngine<Text>::gather(size_t batch, const Of& of) const {
    Pack out{};
    for (size_t t = 8 * batch; t < std::min(8 * batch + 8, texels_); ++t) out.set(int(t % 8), of(states_[t]));
    return out;
}

template <class Text>
template <class Put>
void TexelEngine<Text>::scatter(size_t batch, const Put& put) {
    for (size_t t = 8 * batch; t < std::min(8 * batch + 8, texels_); ++t) put(states_[t], int(t % 8));
}

template <class Text>
ProblemStatistics TexelEngine<Text>::count() {
    ProblemStatistics out;
    out.samples.resize(texels_);
    out.mean.assign(3 * texels_, 0);
    inverse_samples_.assign(batches_.size(), Pack{});
    parallel_for(batches_.size(), 16, [&](size_t b, int) {
        WidePack sum[3] = {};
        for (const auto& row : batches_[b].rows())
            for (size_t c = 0; c < 3; ++c) sum[c] += widen(row.weight * row.target[c]);
        for (size_t t = 8 * b; t < std::min(8 * b + 8, texels_); ++t) {
            const int lane = int(t % 8);
            const uint32_t samples = out.samples[t] = batches_[b].count(lane);
            if (!samples) continue;
            inverse_samples_[b].set(lane, 1 / float(samples));
            for (size_t c = 0; c < 3; ++c) out.mean[3 * t + c] = float(sum[c][lane] / samples);
        }
    });
    return out;
}

template <class Text>
void TexelEngine<Text>::set(std::vector<Vector>& vectors, std::span<const float> from) {
    for (size_t t = 0; t < from.size() / N; ++t)
        for (size_t i = 0; i < N; ++i) vectors[t / 8][i].set(int(t % 8), from[t * N + i]);
}

template <class Text>
void TexelEngine<Text>::reset(std::span<const float> start) {
    Vector zero;
    zero.fill(Pack{});
    for (auto* vectors : {&p_, &trial_, &d_, &g_, &trial_g_, &precondition_, &fresh_})
        vectors->assign(batches_.size(), zero);
    set(trial_, start);
    p_ = trial_;  // what a problem without samples returns
    states_.assign(texels_, {});
    life_.assign(batches_.size(), Life::over);
    for (size_t t = 0; t < texels_; ++t) {
        auto& s = states_[t].state;
        s.error = HUGE_ERROR;
        s.step_factor = 1;
        const Batch& batch = batches_[t / 8];
        s.status = float(!batch.finite(int(t % 8))  ? Status::not_finite
                         : !batch.count(int(t % 8)) ? Status::no_samples
                                                    : Status::active);
    }
    for (size_t b = 0; b < batches_.size(); ++b) set_life(b);
}

template <class Text>
void TexelEngine<Text>::direction_pass(bool diagonal) {
    for_batches(Life::active, [&](size_t b) {
        const FlushSubnormals flush;
        constexpr size_t B = size_t(Model::basis), Q = size_t(Model::shape);
        const Vector& p = trial_[b];
        const auto sums = texel_sums<Text>(batches_[b].rows(), p);
        const Pack scale = inverse_samples_[b];
        const WidePack wide_scale = widen(scale);
        Vector& g = trial_g_[b];
        WidePack error = wide_scale * sums.error;
        for (size_t k = 0; k < B; ++k)
            for (size_t c = 0; c < 3; ++c) g[3 * k + c] = scale * narrow(sums.linear[k][c]);
        for (size_t i = 0; i < Q; ++i) {
            WidePack slope(0.0);
            for (size_t c = 0; c < 3; ++c) slope += widen(p[3 * (B - 1) + c]) * sums.linear[B + i][c];
            g[3 * B + i] = scale * narrow(slope);
        }
        for (size_t i = 0; i < N; ++i) {
            if (!Model::bounded(int(i))) continue;
            const auto [lowest, highest] = Model::bounds(int(i));
            const Pack a{float(lowest)}, o{float(highest)}, mu(mu_), x = p[i];
            const auto outside = (x < a) | (x > o);
            const Pack beyond = x - min(max(x, a), o);
            const bool paper = mode_ == Mode::paper;
            const Pack penalty = paper ? (x - a) * (x - o) : Pack(0.5f) * beyond * beyond;
            error += widen(mu * Pack::select(outside, penalty, 0.0f));
            g[i] += mu * (paper ? Pack::select(outside, x + x - a - o, 0.0f) : beyond);
        }
        const Pack trial_error = narrow(error);
        scatter(b, [&](State& s, int lane) { s.trial_error = trial_error[lane]; });
        if (!diagonal) return;
        Vector& fresh = fresh_[b];
        for (size_t k = 0; k < B; ++k)
            for (size_t c = 0; c < 3; ++c) fresh[3 * k + c] = scale * narrow(sums.shared[k][k]);
        Pack lobe{};
        for (size_t c = 0; c < 3; ++c) lobe += p[3 * (B - 1) + c] * p[3 * (B - 1) + c];
        for (size_t i = 0; i < Q; ++i) fresh[3 * B + i] = scale * lobe * narrow(sums.shared[B + i][B + i]);
        Pack largest{};
        for (const Pack& x : fresh) largest = max(largest, x);
        for (Pack& x : fresh) x = max(x, Pack(1e-4f) * largest + Pack(1e-30f));
    });
}

template <class Text>
void TexelEngine<Text>::project(Rule rule, bool fresh) {
    for_batches(Life::active, [&](size_t b) {
        Pack norm{}, cross{}, conjugate{};
        for (size_t i = 0; i < N; ++i) {
            Pack z = trial_g_[b][i];
            if (rule == Rule::cg_modern) z = z / (fresh ? fresh_ : precondition_)[b][i];
            norm += z * trial_g_[b][i];
            cross += z * g_[b][i];
            conjugate += d_[b][i] * trial_g_[b][i];
        }
        scatter(b, [&](State& s, int lane) {
            s.trial_norm = norm[lane];
            s.cross = cross[lane];
            s.conjugate = conjugate[lane];
        });
    });
}

template <class Text>
void TexelEngine<Text>::after_direction(Rule rule, bool restart, ProblemText<float>::StopRules stop) {
    update_states(Life::ended, [&](State& s) {
        ProblemState::after_direction(s.state, int(rule), restart, s.alpha, 1.0f, stop, s.trial_error, s.trial_norm,
                                      s.cross, s.conjugate);
    });
}

template <class Text>
void TexelEngine<Text>::update_direction(Rule rule, bool fresh) {
    for_batches(Life::ended, [&](size_t b) {
        const Pack accepted = gather(b, [](const State& s) { return s.state.accepted; });
        const Pack beta = gather(b, [](const State& s) { return s.state.beta; });
        const auto taken = accepted > Pack(0.0f);
        for (size_t i = 0; i < N; ++i) {
            p_[b][i] = Pack::select(taken, trial_[b][i], p_[b][i]);
            g_[b][i] = Pack::select(taken, trial_g_[b][i], g_[b][i]);
            Pack z = g_[b][i];
            if (rule == Rule::cg_modern) {
                if (fresh) precondition_[b][i] = Pack::select(taken, fresh_[b][i], precondition_[b][i]);
                z = Pack::select(precondition_[b][i] > Pack(0.0f), z / precondition_[b][i], z);
            }
            d_[b][i] = beta * d_[b][i] - z;
        }
    });
}

template <class Text>
void TexelEngine<Text>::line_pass() {
    for_batches(Life::active, [&](size_t b) {
        const FlushSubnormals flush;
        const Vector &p = p_[b], &d = d_[b];
        WidePack gauss_newton{}, curvature{};
        detail::for_runs(batches_[b].rows(), [&](auto run) {
            Pack squares{}, bends{};
            for (const auto& row : run) {
                const auto terms = detail::terms_of<Text>(row);
                const auto value = Model::value(p, terms);
                const auto bend = Model::bend(p, d, terms);
                for (size_t c = 0; c < 3; ++c) {
                    squares += row.weight * bend.first[c] * bend.first[c];
                    bends += row.weight * (value[c] - row.target[c]) * bend.second[c];
                }
            }
            gauss_newton += widen(squares);
            curvature += widen(squares) + widen(bends);
        });
        const WidePack scale = widen(inverse_samples_[b]);
        Pack penalty{};
        for (size_t i = 0; i < N; ++i) {
            if (!Model::bounded(int(i))) continue;
            const auto [lowest, highest] = Model::bounds(int(i));
            const auto outside = (p[i] < Pack(float(lowest))) | (p[i] > Pack(float(highest)));
            penalty += Pack::select(outside, Pack(mode_ == Mode::paper ? 2 * mu_ : mu_) * d[i] * d[i], 0.0f);
        }
        const Pack first = narrow(scale * gauss_newton) + penalty, whole = narrow(scale * curvature) + penalty;
        scatter(b, [&](State& s, int lane) { s.sums = {first[lane], whole[lane], 0, 0}; });
    });
}

template <class Text>
void TexelEngine<Text>::after_line(Rule rule, ProblemText<float>::StopRules stop) {
    update_states(Life::active,
                  [&](State& s) { ProblemState::after_line(s.state, s.alpha, int(rule), 1.0f, stop, s.sums); });
}

template <class Text>
void TexelEngine<Text>::advance() {
    for_batches(Life::active, [&](size_t b) {
        const Pack step = gather(b, [](const State& s) { return ProblemState::trial_step(s.state, s.alpha); });
        for (size_t i = 0; i < N; ++i) trial_[b][i] = p_[b][i] + step * d_[b][i];
    });
}

template <class Text>
EngineSummary TexelEngine<Text>::summary() const {
    EngineSummary sum;
    for (const State& s : states_) {
        sum.active += s.active();
        sum.accepted += s.state.accepted != 0;
        if (s.state.error < HUGE_ERROR) sum.error += double(s.state.error);
    }
    return sum;
}

template <class Text>
void TexelEngine<Text>::outcomes(std::span<ProblemOutcome> out) const {
    for (size_t t = 0; t < texels_; ++t) {
        const auto& s = states_[t].state;
        out[t] = {s.error < HUGE_ERROR ? s.error : 0, Status(int(s.status)), uint32_t(s.iterations)};
        if (out[t].status == Status::active) out[t].status = Status::max_iterations;
    }
}

template <class Text>
void TexelEngine<Text>::read_errors(std::span<float> out) const {
    for (size_t t = 0; t < texels_; ++t) out[t] = states_[t].state.error;
}

template <class Text>
void TexelEngine<Text>::read_parameters(std::span<float> out) const {
    for (size_t t = 0; t < texels_; ++t)
        for (size_t i = 0; i < N; ++i) out[t * N + i] = p_[t / 8][i][int(t % 8)];
}

template <class Text>
auto TexelEngine<Text>::evaluation(size_t texel) const -> Evaluation {
    Evaluation out{states_[texel].trial_error, {}, {}};
    for (size_t i = 0; i < N; ++i) {
        out.gradient[i] = trial_g_[texel / 8][i][int(texel % 8)];
        out.diagonal[i] = fresh_[texel / 8][i][int(texel % 8)];
    }
    return out;
}

template <class Text>
void TexelEngine<Text>::set_line(std::span<const float> p, std::span<const float> d) {
    set(p_, p);
    set(d_, d);
}

}  // namespace radiafit
