#pragma once
#include "model/lfm.h"
#include "model/texel_model.h"
#include "model/value_curve.h"

namespace radiafit {

/// What a fit of a texel-local model is made of.
///
/// The target of a sample is its pixel's linear value over the lamp's irradiance at the texel, per channel, on the
/// curve: under distant lamps of intensity 1, on sRGB's, what an sRGB picture stores. A sample
/// counts if u_z > 0 and v_z > 0, and neither of the two rules below leaves it out, all channels alike; each problem's
/// E is over its samples' number (S-bar: samples of the texel).
struct TexelOptions {
    const TexelModel* model = nullptr;
    ValueCurve curve = ValueCurve::linear;
    int surface_side = 16;     ///< n of a mesh's atlas; unused for a grid, which brings its texels
    Mode mode = Mode::modern;  ///< of the bounds penalty of streamed optimizers
    float mu = 1;              ///< its weight
    /// Leaves out pixels with a channel at or above this share of the largest value that can be stored, in linear light
    /// and before the view's gain; float encodings have no largest value. 0: off.
    float clip_above = 0;
    /// Leaves out samples darker (sum of channels) than this share of what the texel's Lambertian fit says,
    /// albedo_c u_z with albedo_c = sum t_c u_z / sum u_z^2 over the samples that the rules above leave: cast shadows.
    /// 0: off.
    float shadow_below = 0;
    Loss loss = {};  ///< of streamed optimizers
};
/// Throws UserError unless side, weights and shares are in range.
void check_options(const TexelOptions& options);

/// What a texel with parameters p shows: light over the lamp's irradiance, per channel. u, v: as of
/// TexelModel::value().
Vec3f shown_value(const TexelOptions& options, std::span<const float> p, const Vec3f& u, const Vec3f& v);

/// mu E_b of one texel's parameters, as streamed optimizers add it to E / S-bar.
double bounds_penalty(const TexelOptions& options, std::span<const float> p);

}  // namespace radiafit
