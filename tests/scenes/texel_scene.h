#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "base/rng.h"
#include "gauss.h"
#include "model/texel_local.h"
#include "model/texel_texts.h"

/// Random Lafortune texels and their samples, for tests and benchmarks.
namespace radiafit::testing {

template <class real>
using LafortuneText = texel_text::lafortune<real>;

using LafortuneSample = TexelSample<LafortuneText<double>::term_count>;
using LafortuneTexel = std::vector<LafortuneSample>;
using LafortuneModel = TexelLocal<LafortuneText<double>>;

/// A unit direction with z from `lowest` to 1, uniform in solid angle.
inline LafortuneText<double>::real3 random_direction(Rng& rng, double lowest) {
    const double z = lowest + (1 - lowest) * double(rng.uniform());
    const double angle = 2 * std::numbers::pi * double(rng.uniform()), r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(angle), r * std::sin(angle), z};
}

/// A lobe around the mirror direction with an exponent from n_low to n_high (uniform in its logarithm), canonical.
inline LafortuneModel::Parameters random_lobe(Rng& rng, double n_low, double n_high) {
    LafortuneModel::Parameters p;
    for (size_t c = 0; c < 3; ++c) {
        p[c] = double(rng.uniform(0.05f, 0.8f));
        p[3 + c] = double(rng.uniform(0.1f, 1));
    }
    p[6] = -double(rng.uniform(0.8f, 1.2f));
    p[7] = 1;
    p[8] = std::log(n_low) + std::log(n_high / n_low) * double(rng.uniform());
    const double largest = std::max(-p[6], p[7]);
    p[6] /= largest;
    p[7] /= largest;
    return p;
}

/// `count` pairs of light and view, uniform over the hemisphere down to `lowest`; targets with noise of standard
/// deviation `noise` (a sum of twelve uniform numbers).
inline LafortuneTexel sample_texel(Rng& rng, const LafortuneModel::Parameters& p, size_t count, double noise = 0,
                                   double lowest = 0.1) {
    LafortuneTexel out(count);
    for (LafortuneSample& s : out) {
        const auto u = random_direction(rng, lowest), v = random_direction(rng, lowest);
        const auto terms = LafortuneText<double>::sample_terms(u, v);
        const auto value = LafortuneModel::value(p, terms);
        for (size_t k = 0; k < 3; ++k) s.term[k] = float(terms.x[k]);
        for (size_t c = 0; c < 3; ++c) {
            s.target[c] = float(value[c] + noise * gauss(rng));
        }
    }
    return out;
}

}  // namespace radiafit::testing
