#pragma once
#include <vector>

#include "eval/texel_of_pixel.h"
#include "fit/fit_folder.h"

namespace radiafit {

/// Shows a texel-local model under a view's lamp: pixel -> texel, as in fitting, then the model as the texel's centre
/// is lit and seen, times the lamp's irradiance there. Nothing casts a shadow.
class ReflectanceRenderer {
public:
    /// Both must outlive the renderer. Throws std::invalid_argument when their sizes disagree.
    ReflectanceRenderer(const Atlas& atlas, const ReflectanceFit& fit);

    /// rgb [height][width][3] out: linear light, unclamped; 0 where nothing is seen, where the lamp is below the
    /// texel's horizon, and in texels without samples. `pixels` as Contestant gets them. Thread-safe.
    void shade(const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb) const;
    uint32_t texel_of(const RasterPixel& pixel) const { return texel_of_(pixel); }

private:
    const Atlas* atlas_;
    TexelOfPixel texel_of_;
    const ReflectanceFit* fit_;
};

}  // namespace radiafit
