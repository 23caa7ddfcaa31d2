#pragma once
#include <memory>
#include <string>
#include <vector>

#include "eval/contestant.h"
#include "fitting/fitted.h"
#include "geometry/atlas.h"

/// What a fit comes to in the terms of other programs' materials, whatever its family.
namespace radiafit::tools {

struct SurfaceLook {
    std::shared_ptr<const Atlas> atlas;
    SurfaceLookup lookup = SurfaceLookup::nearest;  ///< between its texels
    std::vector<Vec3f> base_colour;                 ///< [texels] linear light, white = 1, not below 0
    std::vector<float> roughness;                   ///< [texels] as glTF's, in [0, 1]; empty: the model has no lobe
    bool albedo = false;                            ///< base_colour is one; else the light that stayed is in it
    std::string meaning;                            ///< of base_colour, and of roughness
};

/// glTF's roughness, whose square is the width alpha of a GGX lobe, of a lobe cos^n about the mirrored direction. By
/// half vectors the exponent is 4n, and a Blinn-Phong lobe of that is as wide as alpha^2 = 2 / (4n + 2) (Walter et al.,
/// EGSR 2007): roughness = (2n + 1)^(-1/4). A spherical Gaussian of sharpness lambda is a cos^lambda.
float roughness_of(double exponent);
/// A lobe that adds less than this to white has no width to speak of: its texel counts as rough.
inline constexpr float least_lobe = 1.0f / 255;

/// The fit, its atlas and the dataset must outlive what they return. training: the views that were fitted.
///  - Of a texel-local model the albedo is its diffuse coefficient, or the Lambertian one nearest to it over the
///  training images; the roughness that of its lobe.
///  - Of spherical Gaussians the base colour is the diffuse one; the sharpness is the mean of log lambda, weighted by
///    what each lobe has at its peak.
///  - Of a light basis the albedo is the Lambertian one nearest to it under training lamps.
///  - Of others it is the mean of what the fit shows to training cameras, weighted by the cosine under which they see
///    the texel, whatever hides it.
SurfaceLook look_of(const ReflectanceFit& fit, const Atlas& atlas, const Dataset& dataset,
                    const std::vector<uint32_t>& training);
SurfaceLook look_of(const SgFit& fit, const TriangleAtlas& atlas, const Dataset& dataset,
                    const std::vector<uint32_t>& training);
SurfaceLook look_of(const ViewBasisFit& fit, const TriangleAtlas& atlas, const Dataset& dataset,
                    const std::vector<uint32_t>& training);
SurfaceLook look_of(const LightBasisFit& fit, const Atlas& atlas, const Dataset& dataset,
                    const std::vector<uint32_t>& training);
SurfaceLook look_of(const LightFieldFit& fit, const Dataset& dataset, const std::vector<uint32_t>& training);
SurfaceLook look_of(Fitted& fitted);

}  // namespace radiafit::tools
