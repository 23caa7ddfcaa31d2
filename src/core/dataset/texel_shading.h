#pragma once
#include <vector>

#include "dataset/dataset.h"
#include "geometry/mesh.h"

namespace radiafit {

/// How views see and light the texels of an atlas (docs/formats.md, "What a light means"). All views have a light.
class TexelShading {
public:
    /// What belongs to a texel, whatever the view.
    struct Place {
        Vec3d position;  ///< world space, the texel's centre
        Frame frame;     ///< z is its normal
    };
    struct Lit {
        Vec3f u, v;        ///< unit directions to lamp and camera, in the frame
        Vec3f irradiance;  ///< linear RGB of a white diffuse surface that faces the lamp
    };

    /// The dataset must outlive it.
    TexelShading(const Dataset& dataset, const std::vector<uint32_t>& views);

    static Place place(const Atlas& atlas, uint32_t texel);
    /// `image`: position in `views`.
    Lit lit(const Place& place, uint32_t image) const { return lit(place, *views_[image]); }
    static Lit lit(const Place& place, const View& view);

private:
    std::vector<const View*> views_;
};

}  // namespace radiafit
