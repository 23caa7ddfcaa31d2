#pragma once
#include <vector>

#include "basis/solve_on_device.h"
#include "dataset/dataset.h"
#include "geometry/atlas.h"
#include "samples/sample_list.h"
#include "viewbasis/view_basis.h"

namespace radiafit::fits {

/// The normal, and the two directions across it, one as near to `up` as can be. All unit vectors.
Frame view_frame(const Vec3f& normal, const Vec3f& up);

/// Direction from a texel's centre to a camera in the texel's frame, a unit vector.
inline Vec3f view_direction(const Frame& frame, const Vec3f& position, const Vec3f& eye) {
    return frame.to_local((eye - position).normalized());
}
/// The weight of a sample seen in this direction: the cosine with the normal, at least a little.
inline float view_sample_weight(const Vec3f& direction) {
    return ViewText::view_weight({direction.x(), direction.y(), direction.z()});
}

/// What a camera sees of a texel, by view_direction().
using TexelView = SeenColour;

class TexelViewReader {
public:
    /// All arguments must outlive it.
    TexelViewReader(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples, const Vec3f& up);
    /// What cameras see of a texel, images ascending.
    void read(uint32_t tile, uint32_t local, std::vector<TexelView>& out) const;
    /// The same for all of a tile's texels, [texels of the tile].
    void read(uint32_t tile, std::vector<std::vector<TexelView>>& out) const;
    const Vec3f& eye(uint32_t image) const { return eyes_[image]; }

private:
    struct Place {
        Vec3f position;
        Frame frame;
    };
    Place place_of(uint32_t tile, uint32_t local) const;
    TexelView view_of(const Place& place, uint32_t group, const Sample& sample) const;

    const TriangleAtlas* atlas_;
    const SampleList* samples_;
    Vec3f up_;
    std::vector<Vec3f> eyes_;  ///< [images]
};

/// Where cameras have their upper edge, on average; a unit vector.
Vec3f mean_up(const Dataset& dataset);

}  // namespace radiafit::fits
