#pragma once
#include "dataset/truth.h"
#include "geometry/atlas.h"
#include "geometry/light.h"
#include "synthetic/ornament_options.h"
#include "synthetic/render_view.h"

namespace radiafit {

/// A surface of texels: what each is made of, with which normal.
struct TexelSurface {
    const TriangleAtlas& atlas;
    const ReflectanceTruth& truth;
};

/// Light reflected by texel `texel`'s material at x (in the texel) to a camera at `eye`: linear RGB. No shadows: the
/// texel is lit where its own normal faces the lamp, else black. A texel whose relief faces away from the camera
/// (v_z <= 0) is drawn all the same; models that leave such samples out know them by their normals.
Vec3d reflected(const TexelSurface& surface, uint32_t texel, const Vec3d& x, const Vec3d& eye, const Light& light);

/// Scratch space is kept: one per thread.
class TexelSurfaceRenderer {
public:
    void render(const TexelSurface& surface, const Camera& camera, const Light& light, Shading shading,
                LinearImage& image);

private:
    Rasterizer rasterizer_;
};

}  // namespace radiafit
