#include "cpu/lfm_engine.h"

namespace radiafit {

template <class Problem>
template <class Body>
void LfmEngine<Problem>::for_active(const Body& body) {
    const auto& layout = problem_->layout();
    parallel_for(vertices_.size(), 8, [&](size_t v, int) {
        if (vertices_[v].active()) body(v, layout.offset(v) / 4, layout.offset(v + 1) / 4);
    });
}

template <class Problem>
ProblemStatistics LfmEngine<Problem>::count() {
    ProblemStatistics statistics = problem_->count();
    samples_ = statistics.samples;
    return statistics;
}

template <class Problem>
void LfmEngine<Problem>::reset(std::span<const float> start) {
    const size_t n = problem_->layout().size() / 4;
    for (auto* vector : {&p_, &trial_, &d_, &g_, &trial_g_, &precondition_, &fresh_}) vector->assign(n, V{});
    for (size_t i = 0; i < n; ++i)
        for (int c = 0; c < 4; ++c) trial_[i][c] = start[4 * i + c];
    p_ = trial_;  // what a problem without samples returns
    vertices_.assign(problem_->vertex_count(), {});
    for (size_t v = 0; v < vertices_.size(); ++v)
        for (Channel& c : vertices_[v].channel) {
            c = {};
            c.state.error = HUGE_ERROR;
            c.state.step_factor = 1;
            c.state.status = real(samples_[v] ? Status::active : Status::no_samples);
        }
}

template <class Problem>
void LfmEngine<Problem>::direction_pass(bool diagonal) {
    for_active([&](size_t v, size_t begin, size_t end) {
        double error[3];
        problem_->direction(v, &trial_[begin], &trial_g_[begin], diagonal ? &fresh_[begin] : nullptr, error);
        for (int c = 0; c < 3; ++c) vertices_[v].channel[c].trial_error = real(error[c]);
        const int terms = problem_->layout().terms();
        if (first_term_ <= 0 && last_term_ >= terms) return;
        for (size_t i = begin; i < end; ++i) {
            const int k = int((i - begin) % size_t(terms));
            if (k < first_term_ || k >= last_term_) trial_g_[i] = V{};
        }
    });
}

template <class Problem>
void LfmEngine<Problem>::project(Rule rule, bool fresh) {
    const V* weight = rule != Rule::cg_modern ? nullptr : fresh ? fresh_.data() : precondition_.data();
    for_active([&](size_t v, size_t begin, size_t end) {
        V norm{}, cross{}, conjugate{};
        for (size_t i = begin; i < end; ++i) {
            const V z = weight ? trial_g_[i] / weight[i] : trial_g_[i];
            norm += z * trial_g_[i];
            cross += z * g_[i];
            conjugate += d_[i] * trial_g_[i];
        }
        for (int c = 0; c < 3; ++c) {
            Channel& channel = vertices_[v].channel[c];
            channel.trial_norm = norm[c];
            channel.cross = cross[c];
            channel.conjugate = conjugate[c];
        }
    });
}

template <class Problem>
void LfmEngine<Problem>::after_direction(Rule rule, bool restart, ProblemText<float>::StopRules stop) {
    for (size_t v = 0; v < vertices_.size(); ++v)
        for (Channel& c : vertices_[v].channel)
            Text::after_direction(c.state, int(rule), restart, c.alpha, real(problem_->ring_texels(v)),
                                  {stop.residual, stop.output_change}, c.trial_error, c.trial_norm, c.cross,
                                  c.conjugate);
}

template <class Problem>
void LfmEngine<Problem>::update_direction(Rule rule, bool fresh) {
    const auto& layout = problem_->layout();
    parallel_for(vertices_.size(), 8, [&](size_t v, int) {
        V accepted{}, beta{};
        bool any = vertices_[v].active();
        for (int c = 0; c < 3; ++c) {
            accepted[c] = vertices_[v].channel[c].state.accepted;
            beta[c] = vertices_[v].channel[c].state.beta;
            any = any || accepted[c] != 0;  // a problem may stop with the trial it accepts
        }
        if (!any) return;
        for (size_t i = layout.offset(v) / 4; i < layout.offset(v + 1) / 4; ++i) {
            p_[i] = accepted != 0 ? trial_[i] : p_[i];
            g_[i] = accepted != 0 ? trial_g_[i] : g_[i];
            V z = g_[i];
            if (rule == Rule::cg_modern) {
                if (fresh) precondition_[i] = accepted != 0 ? fresh_[i] : precondition_[i];
                z = precondition_[i] != 0 ? g_[i] / precondition_[i] : g_[i];
            }
            d_[i] = beta * d_[i] - z;
        }
    });
}

template <class Problem>
void LfmEngine<Problem>::line_pass() {
    for_active([&](size_t v, size_t begin, size_t) {
        LineLanes sums;
        problem_->line(v, &p_[begin], &d_[begin], sums);
        for (int c = 0; c < 3; ++c)
            vertices_[v].channel[c].sums = {real(sums.gauss_newton[c]), real(sums.curvature[c]), real(sums.third[c]),
                                            real(sums.fourth[c])};
    });
}

template <class Problem>
void LfmEngine<Problem>::after_line(Rule rule, ProblemText<float>::StopRules stop) {
    for (size_t v = 0; v < vertices_.size(); ++v)
        for (Channel& c : vertices_[v].channel)
            Text::after_line(c.state, c.alpha, int(rule), real(problem_->ring_texels(v)),
                             {stop.residual, stop.output_change}, c.sums);
}

template <class Problem>
void LfmEngine<Problem>::advance() {
    for_active([&](size_t v, size_t begin, size_t end) {
        V step{};
        for (int c = 0; c < 3; ++c)
            step[c] = Text::trial_step(vertices_[v].channel[c].state, vertices_[v].channel[c].alpha);
        for (size_t i = begin; i < end; ++i) trial_[i] = p_[i] + step * d_[i];
    });
}

template <class Problem>
EngineSummary LfmEngine<Problem>::summary() const {
    EngineSummary sum;
    for (const Vertex& v : vertices_)
        for (const Channel& c : v.channel) {
            sum.active += c.state.status == real(Status::active);
            sum.accepted += c.state.accepted != 0;
            if (c.state.status != real(Status::no_samples)) sum.error += c.state.error;
        }
    return sum;
}

template <class Problem>
void LfmEngine<Problem>::outcomes(std::span<ProblemOutcome> out) const {
    for (size_t i = 0; i < problem_count(); ++i) {
        const auto& s = vertices_[i / 3].channel[i % 3].state;
        const bool none = s.status == real(Status::no_samples);
        out[i] = {none ? 0.0f : float(s.error), Status(int(s.status)), uint32_t(s.iterations)};
        if (out[i].status == Status::active) out[i].status = Status::max_iterations;
    }
}

template <class Problem>
void LfmEngine<Problem>::read_errors(std::span<float> out) const {
    for (size_t i = 0; i < problem_count(); ++i) out[i] = float(vertices_[i / 3].channel[i % 3].state.error);
}

template <class Problem>
void LfmEngine<Problem>::read_parameters(std::span<float> out) const {
    for (size_t i = 0; i < p_.size(); ++i)
        for (int c = 0; c < 4; ++c) out[4 * i + c] = float(p_[i][c]);
}

template <class Problem>
uint64_t LfmEngine<Problem>::bytes() const {
    return 7 * p_.size() * sizeof(V) + vertices_.size() * sizeof(Vertex);
}

template class LfmEngine<LfmProblem<float>>;
template class LfmEngine<LfmProblem<double>>;
template class LfmEngine<VertexProblem>;

}  // namespace radiafit
