#pragma once
#include "samples/distributor.h"

namespace radiafit {

/// Distribution over a grid: every texel takes the pixel at its own place, if the mask holds it and it is usable.
class GridDistributor final : public Distributor {
public:
    explicit GridDistributor(const GridAtlas& atlas) : atlas_(&atlas) {}
    void distribute(const Camera&, const TargetImage& image, Distribution& out) override {
        out.texel_pixel.resize(atlas_->texel_count());
        out.covered_pixels = 0;
        for (uint32_t texel = 0; texel < atlas_->texel_count(); ++texel) {
            const bool takes = atlas_->usable(texel) && image.masked_in(texel);
            out.texel_pixel[texel] = takes ? texel : no_pixel;
            out.covered_pixels += takes;
        }
        out.kept_pixels = out.covered_pixels;
    }

private:
    const GridAtlas* atlas_;
};

}  // namespace radiafit
