#pragma once
#include <vector>

#include "samples/distributor.h"

namespace radiafit {

/// What another distributor finds, of some texels alone.
class OnlyTexels final : public Distributor {
public:
    /// Both must outlive it. texels: [texel_count()]
    OnlyTexels(Distributor& all, const std::vector<bool>& texels) : all_(&all), texels_(&texels) {}
    void distribute(const Camera& camera, const TargetImage& image, Distribution& out) override {
        all_->distribute(camera, image, out);
        for (size_t t = 0; t < out.texel_pixel.size(); ++t)
            if (!(*texels_)[t]) out.texel_pixel[t] = no_pixel;
    }

private:
    Distributor* all_;
    const std::vector<bool>* texels_;
};

}  // namespace radiafit
