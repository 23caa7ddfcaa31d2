#include "samples/texel_loader.h"

#include <algorithm>
#include <limits>

#include "dataset/encoding.h"

namespace radiafit {

TexelLoader::TexelLoader(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                         const TexelOptions& options)
    : atlas_(&atlas),
      shading_(dataset, views),
      shadow_below_(options.shadow_below),
      weights_(options.loss.weights),
      curve_(options.curve) {
    const bool clips = has_largest_value(dataset.encoding) && options.clip_above > 0;
    for (const uint32_t view : views)
        clipped_.push_back(clips ? options.clip_above * float(dataset.views[view].gain[0])
                                 : std::numeric_limits<float>::infinity());
}

TexelLoader TexelLoader::of(std::vector<uint32_t> texels) const {
    TexelLoader out = *this;
    out.texels_ = std::move(texels);
    return out;
}

void TexelLoader::load(uint32_t texel, std::span<const TexelRadiance> samples, std::vector<ShadedSample>& out,
                       std::vector<uint32_t>* which) const {
    out.clear();
    if (which) which->clear();
    if (samples.empty()) return;
    const TexelShading::Place place = TexelShading::place(*atlas_, texels_.empty() ? texel : texels_[texel]);
    for (const TexelRadiance& s : samples) {
        const float limit = clipped_[s.image];
        if (s.value[0] >= limit || s.value[1] >= limit || s.value[2] >= limit) continue;
        const TexelShading::Lit lit = shading_.lit(place, s.image);
        if (!(lit.u.z() > 0 && lit.v.z() > 0)) continue;
        // where a lamp sends no light of a colour, the pixel says nothing of it, and is 0
        const auto target = [&](int c) { return lit.irradiance[c] > 0 ? s.value[c] / lit.irradiance[c] : 0.0f; };
        out.push_back({lit.u, lit.v, {target(0), target(1), target(2)}, float(sample_weight(weights_, lit.v.z()))});
        if (which) which->push_back(uint32_t(&s - samples.data()));
    }
    if (shadow_below_ > 0) leave_out_shadows(out, which);
    if (curve_ == ValueCurve::linear) return;
    for (ShadedSample& s : out)
        for (float& target : s.target) target = on_curve(curve_, target);
}

void TexelLoader::leave_out_shadows(std::vector<ShadedSample>& out, std::vector<uint32_t>* which) const {
    const float albedo = lambertian_albedo(out).sum();
    size_t kept = 0;
    for (size_t i = 0; i < out.size(); ++i) {
        const ShadedSample& s = out[i];
        if (s.target[0] + s.target[1] + s.target[2] < shadow_below_ * albedo * s.u.z()) continue;
        if (which) (*which)[kept] = (*which)[i];
        out[kept++] = s;
    }
    out.resize(kept);
    if (which) which->resize(kept);
}

Vec3f lambertian_albedo(std::span<const ShadedSample> samples) {
    Vec3d sum = Vec3d::Zero();
    double squares = 0;
    for (const ShadedSample& s : samples) {
        const double z = double(s.u.z());
        for (int c = 0; c < 3; ++c) sum[c] += z * double(s.target[c]);
        squares += z * z;
    }
    return squares > 0 ? Vec3f((sum / squares).cast<float>()) : Vec3f::Zero();
}

}  // namespace radiafit
