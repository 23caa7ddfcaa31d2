#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "base/rings.h"
#include "model/texel_local.h"
#include "samples/texel_loader.h"

namespace radiafit::fits {

template <class Text>
using TexelSamples = std::span<const TexelSample<Text::term_count>>;

template <class Text>
typename Text::Terms terms_of(const TexelSample<Text::term_count>& sample) {
    typename Text::Terms t;
    std::copy(sample.term.begin(), sample.term.end(), t.x);
    return t;
}

/// sqrt(w) (m_c - target_c), [sample][channel]. jacobian, if not null: of row i by parameter k at
/// [i * row_step + k * column_step].
template <class Text>
void texel_residuals(TexelSamples<Text> samples, const typename TexelLocal<Text>::Parameters& p, double* residuals,
                     double* jacobian, size_t row_step, size_t column_step) {
    using Model = TexelLocal<Text>;
    constexpr size_t B = size_t(Model::basis), N = size_t(Model::parameters);
    const auto shape = Model::shape_of(p);
    if (jacobian) std::fill_n(jacobian, 3 * samples.size() * N, 0.0);
    for (const auto& sample : samples) {
        const double root = std::sqrt(double(sample.weight));
        const typename Model::Terms t = terms_of<Text>(sample);
        if (!jacobian) {
            const auto value = Model::value(p, t);
            for (size_t c = 0; c < 3; ++c) *residuals++ = root * (value[c] - double(sample.target[c]));
            continue;
        }
        const auto q = Model::columns(shape, t);
        for (size_t c = 0; c < 3; ++c, jacobian += row_step) {
            double value = 0;
            for (size_t k = 0; k < B; ++k) {
                value += p[3 * k + c] * q[k];
                jacobian[(3 * k + c) * column_step] = root * q[k];
            }
            for (int i = 0; i < Model::slopes; ++i)
                jacobian[(3 * B + size_t(Model::slope_shape(i))) * column_step] +=
                    root * p[3 * size_t(Model::slope_basis(i)) + c] * q[B + size_t(i)];
            *residuals++ = root * (value - double(sample.target[c]));
        }
    }
}

}  // namespace radiafit::fits
