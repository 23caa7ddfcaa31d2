#pragma once
#include <vector>

#include "dataset/dataset.h"
#include "geometry/mesh.h"

namespace radiafit {

/// How views see and light the texels of an atlas (docs/formats.md, "What a light means"). A dataset without lights is
/// seen under a lamp at the camera, of intensity 1 and distant.
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

    TexelShading(const std::vector<View>& views, const std::vector<uint32_t>& chosen);

    static Place place(const Atlas& atlas, uint32_t texel) {
        return {atlas.position(texel).cast<double>(), make_frame(atlas.normal(texel))};
    }
    /// `image`: position in `chosen`.
    Lit lit(const Place& place, uint32_t image) const { return lit(place, *views_[image]); }
    static Lit lit(const Place& place, const View& view);

private:
    std::vector<const View*> views_;
};

}  // namespace radiafit
