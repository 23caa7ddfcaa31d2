#pragma once
#include "dataset/texel_shading.h"
#include "model/texel_options.h"
#include "samples/texel_source.h"

namespace radiafit {

/// A sample that counts, as a texel-local model sees it.
struct ShadedSample {
    Vec3f u, v;       ///< unit directions to lamp and camera in the texel's frame, z > 0
    float target[3];  ///< value over irradiance, on the curve
    float weight;     ///< see SampleWeights
};

/// From a texel's pixels to samples, by the rules of TexelOptions.
class TexelLoader {
public:
    /// The dataset and the atlas must outlive it.
    TexelLoader(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                const TexelOptions& options);
    /// The same for these texels alone, numbered anew in their order.
    TexelLoader of(std::vector<uint32_t> texels) const;
    /// Thread-safe. Reuses out's storage. `which`, if given: the samples' places in what was asked for.
    void load(uint32_t texel, std::span<const TexelRadiance> samples, std::vector<ShadedSample>& out,
              std::vector<uint32_t>* which = nullptr) const;

private:
    void leave_out_shadows(std::vector<ShadedSample>& samples, std::vector<uint32_t>* which) const;

    const Atlas* atlas_;
    std::vector<uint32_t> texels_;  ///< of the atlas, in their order; empty: all
    TexelShading shading_;
    float shadow_below_;
    SampleWeights weights_;
    ValueCurve curve_;
    std::vector<float> clipped_;  ///< [views] values from here on are left out
};

/// albedo_c = sum t_c u_z / sum u_z^2; 0 without samples.
Vec3f lambertian_albedo(std::span<const ShadedSample> samples);

}  // namespace radiafit
