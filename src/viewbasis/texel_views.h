#pragma once
#include <vector>

#include "dataset/dataset.h"
#include "geometry/atlas.h"
#include "samples/sample_list.h"
#include "viewbasis/view_basis.h"

namespace radiafit {

/// Direction from a texel's centre to a camera in the texel's frame, a unit vector.
inline Vec3f view_direction(const Frame& frame, const Vec3f& position, const Vec3f& eye) {
    return frame.to_local((eye - position).normalized());
}
/// Of a sample seen in this direction: the cosine with the normal, at least a little.
inline float view_sample_weight(const Vec3f& direction) {
    return view_text::ViewPolynomials<float>::view_weight({direction.x(), direction.y(), direction.z()});
}

/// What the cameras of a sample list see of a texel.
struct TexelViews {
    std::vector<ViewTerms> terms;
    std::vector<Vec3f> colours;
    std::vector<float> weights;
};

class TexelViewReader {
public:
    /// All arguments must outlive it.
    TexelViewReader(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples, const Vec3f& up);
    void read(uint32_t tile, uint32_t local, TexelViews& out) const;
    const Vec3f& eye(uint32_t image) const { return eyes_[image]; }

private:
    const TriangleAtlas* atlas_;
    const SampleList* samples_;
    Vec3f up_;
    std::vector<Vec3f> eyes_;  ///< [images]
};

/// Three numbers, as JSON takes and gives them. Throws std::runtime_error unless they are three, and finite.
std::array<double, 3> numbers_of(const Vec3f& v);
Vec3f vector_of(const std::vector<float>& numbers);

/// Where cameras have their upper edge, on average; a unit vector.
Vec3f mean_up(const Dataset& dataset);

}  // namespace radiafit
