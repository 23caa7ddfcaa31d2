#pragma once
#include <vector>

#include "eval/shown_texels.h"
#include "fit/fit_folder.h"
#include "geometry/atlas.h"
#include "geometry/raster.h"
#include "geometry/surface_lookup.h"

namespace radiafit {

/// Shows a light field map from any camera: pixel -> texels, by the fit's look-up, then the sum over the triangle's
/// three vertices and the terms of g_k[texel] h_k(view direction of the vertex) (Eq. 14) at each of these, and their
/// mix.
class LfmRenderer {
public:
    /// Both must outlive the renderer. Throws std::invalid_argument when their sizes disagree.
    LfmRenderer(const Mesh& mesh, const LightFieldFit& fit);

    /// rgb [height][width][3] out: the model's values, unclamped, in the fit's space; 0 where no triangle is seen.
    /// A vertex and channel whose problem never had a sample contributes 0 (black), whatever its parameters are.
    /// Calls with different `worker` (parallel_for's) may run at once.
    void shade(const Camera& camera, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb, int worker = 0);

private:
    struct Scratch {
        std::vector<float> view;      ///< [V][K][4]: h_k of the vertices met so far
        std::vector<uint32_t> drawn;  ///< [V] the picture for which `view` was computed last
        uint32_t picture = 0;
        ShownTexels<Eigen::Array4f> shown;  ///< r, g, b and padding
    };
    const float* view_values(Scratch& scratch, uint32_t vertex, const Vec3d& eye) const;

    const Mesh* mesh_;
    const LightFieldFit* fit_;
    TriangleAtlas atlas_;
    TexelLookup lookup_;
    VertexRings rings_;
    LfmLayout layout_;
    std::vector<Frame> frames_;
    std::vector<Scratch> scratch_;  ///< per worker
};

}  // namespace radiafit
