#pragma once
#include "base/flush_subnormals.h"
#include "base/instructions.h"
#include "base/parallel.h"
#include "cpu/texel_batches.h"
#include "cpu/texel_sums.h"
#include "model/penalty.h"

/// The definitions of TexelBatches: for the files that instantiate it.
namespace radiafit {

template <class Text>
Status TexelBatches<Text>::first_status(size_t texel) const {
    const Batch& batch = batches_[texel / size_t(lanes)];
    const int lane = int(texel % size_t(lanes));
    return !batch.finite(lane) ? Status::not_finite : !batch.count(lane) ? Status::no_samples : Status::active;
}

template <class Text>
ProblemStatistics TexelBatches<Text>::count() {
    ProblemStatistics out;
    out.samples.resize(texels_);
    out.mean.assign(3 * texels_, 0);
    inverse_samples_.assign(batches_.size(), Pack{});
    parallel_for(batches_.size(), 16, [&](size_t b, int) {
        WidePack sum[3] = {}, weights = {};
        for (const auto& row : batches_[b].rows()) {
            weights += widen(row.weight);
            for (size_t c = 0; c < 3; ++c) sum[c] += widen(row.weight * row.target[c]);
        }
        for (size_t t = 8 * b; t < std::min(8 * b + 8, texels_); ++t) {
            const int lane = int(t % 8);
            const uint32_t samples = out.samples[t] = batches_[b].count(lane);
            if (!samples) continue;
            inverse_samples_[b].set(lane, 1 / float(samples));
            for (size_t c = 0; c < 3; ++c) out.mean[3 * t + c] = float(sum[c][lane] / weights[lane]);
        }
    });
    return out;
}

template <class Text>
void TexelBatches<Text>::set(std::span<const float> values, Pack* vector) const {
    for (size_t t = 0; t < values.size() / N; ++t)
        for (size_t i = 0; i < N; ++i) vector[t / 8 * N + i].set(int(t % 8), values[t * N + i]);
}

template <class Text>
void TexelBatches<Text>::get(const Pack* vector, std::span<float> values) const {
    for (size_t t = 0; t < texels_; ++t)
        for (size_t i = 0; i < N; ++i) values[t * N + i] = vector[t / 8 * N + i][int(t % 8)];
}

template <class Text>
void TexelBatches<Text>::direction(size_t block, const Pack* x, Pack* g, Pack* diagonal, double errors[lanes]) const {
    const FlushSubnormals flush;
    constexpr size_t B = size_t(Model::basis), Q = size_t(Model::shape);
    const auto p = parameters(x);
    TexelSums<Text> sums;
    with_loss(loss_, [&](auto loss) {
        with_widest_vectors([&] { sums = texel_sums<Text>(batches_[block].rows(), p, loss); });
    });
    const Pack scale = inverse_samples_[block];
    const WidePack wide_scale = widen(scale);
    WidePack error = wide_scale * sums.error;
    for (size_t k = 0; k < B; ++k)
        for (size_t c = 0; c < 3; ++c) g[3 * k + c] = scale * narrow(sums.linear[k][c]);
    std::array<WidePack, Q> slopes{};
    for (size_t i = 0; i < size_t(Model::slopes); ++i) {
        WidePack& slope = slopes[size_t(Model::slope_shape(int(i)))];
        for (size_t c = 0; c < 3; ++c)
            slope += widen(p[3 * size_t(Model::slope_basis(int(i))) + c]) * sums.linear[B + i][c];
    }
    for (size_t i = 0; i < Q; ++i) g[3 * B + i] = scale * narrow(slopes[i]);
    for (size_t i = 0; i < N; ++i) {
        if (!Model::bounded(int(i))) continue;
        const auto [lowest, highest] = Model::bounds(int(i));
        const Pack low{float(lowest)}, high{float(highest)}, mu(mu_);
        error += widen(ObjectiveText<Pack>::bound_error(p[i], low, high, mu, mode_ == Mode::paper));
        g[i] += ObjectiveText<Pack>::bound_slope(p[i], low, high, mu, mode_ == Mode::paper);
        if (Model::held(int(i))) g[i] = Pack{};
    }
    for (int lane = 0; lane < lanes; ++lane) errors[lane] = error[lane];
    if (!diagonal) return;
    for (size_t k = 0; k < B; ++k)
        for (size_t c = 0; c < 3; ++c) diagonal[3 * k + c] = scale * narrow(sums.shared[k][k]);
    for (size_t i = 0; i < Q; ++i) diagonal[3 * B + i] = Pack{};
    for (size_t i = 0; i < size_t(Model::slopes); ++i)
        for (size_t j = 0; j < size_t(Model::slopes); ++j) {
            const size_t number = size_t(Model::slope_shape(int(i)));
            if (size_t(Model::slope_shape(int(j))) != number) continue;
            const size_t one = 3 * size_t(Model::slope_basis(int(i))), other = 3 * size_t(Model::slope_basis(int(j)));
            Pack lobe{};
            for (size_t c = 0; c < 3; ++c) lobe += p[one + c] * p[other + c];
            diagonal[3 * B + number] += scale * lobe * narrow(sums.shared[B + std::max(i, j)][B + std::min(i, j)]);
        }
    Pack largest{};
    for (size_t i = 0; i < N; ++i) largest = max(largest, diagonal[i]);
    for (size_t i = 0; i < N; ++i) diagonal[i] = ObjectiveText<Pack>::preconditioner(diagonal[i], largest, 1e-30f);
}

template <class Text>
void TexelBatches<Text>::line(size_t block, const Pack* x, const Pack* along, Sums& sums) const {
    const FlushSubnormals flush;
    const auto p = parameters(x), d = parameters(along);
    WidePack gauss_newton{}, curvature{};
    with_loss(loss_, [&](auto loss) {
        with_widest_vectors([&] {
            detail::for_runs(batches_[block].rows(), [&](auto run) {
                Pack squares{}, bends{};
                for (const auto& row : run) {
                    const auto terms = detail::terms_of<Text>(row);
                    auto r = Model::value(p, terms);
                    const auto bend = Model::bend(p, d, terms);
                    for (size_t c = 0; c < 3; ++c) r[c] = r[c] - row.target[c];
                    Pack weight = row.weight;
                    if constexpr (decltype(loss)::reweighs)
                        weight *= loss.weight(weight * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]));
                    for (size_t c = 0; c < 3; ++c) {
                        squares += weight * bend.first[c] * bend.first[c];
                        bends += weight * r[c] * bend.second[c];
                    }
                }
                gauss_newton += widen(squares);
                curvature += widen(squares) + widen(bends);
            });
        });
    });
    const WidePack scale = widen(inverse_samples_[block]);
    Pack penalty{};
    for (size_t i = 0; i < N; ++i) {
        if (!Model::bounded(int(i))) continue;
        const auto [lowest, highest] = Model::bounds(int(i));
        const Pack low{float(lowest)}, high{float(highest)};
        penalty += ObjectiveText<Pack>::bound_curvature(p[i], d[i], low, high, mu_, mode_ == Mode::paper);
    }
    sums = {narrow(scale * gauss_newton) + penalty, narrow(scale * curvature) + penalty, Pack{}, Pack{}};
}

}  // namespace radiafit
