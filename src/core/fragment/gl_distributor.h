#pragma once
#include <optional>

#include "fragment/sls_mesh.h"
#include "gl/context.h"
#include "samples/distributor.h"

namespace radiafit {

/// Distribution by OpenGL, exactly the two passes of Section 5.1.1: the texture item buffer in image space, then the
/// mesh's triangles rasterized into SLS, where every texel looks at the item of the pixel its centre projects to.
/// The context must stay current wherever distribute() is called.
class GlDistributor final : public Distributor {
public:
    explicit GlDistributor(const TriangleAtlas& atlas);
    void distribute(const Camera& camera, const TargetImage& image, Distribution& out) override;

private:
    SlsMesh mesh_;
    Program program_;
    Texture taken_;
    Framebuffer framebuffer_;
    std::optional<ItemBuffer> items_;  ///< for the largest image so far
    std::optional<ImageSlot> slot_;
    int bits_ = 0;
    std::vector<uint32_t> places_, item_pixels_;
};

}  // namespace radiafit
