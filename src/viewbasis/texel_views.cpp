#include "viewbasis/texel_views.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace radiafit {

TexelViewReader::TexelViewReader(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                                 const Vec3f& up)
    : atlas_(&atlas), samples_(&samples), up_(up) {
    for (const uint32_t view : samples.views) eyes_.push_back(dataset.views[view].camera.center().cast<float>());
}

void TexelViewReader::read(uint32_t tile, uint32_t local, TexelViews& out) const {
    out.terms.clear();
    out.colours.clear();
    out.weights.clear();
    const uint32_t texel = tile * atlas_->texels_per_tile() + local;
    const Vec3f position = atlas_->position(texel);
    const Frame frame = view_frame(atlas_->normal(texel), up_);
    for (uint32_t g = samples_->tile_groups[tile]; g < samples_->tile_groups[tile + 1]; ++g) {
        const auto group = samples_->of_group(g);
        const auto found = std::ranges::lower_bound(group, local, {}, &Sample::local);
        if (found == group.end() || found->local != local) continue;
        const Vec3f direction = view_direction(frame, position, eyes_[samples_->groups[g].image]);
        out.terms.push_back(view_polynomials(direction));
        out.colours.push_back(samples_->scale * Vec3f(found->rgb[0], found->rgb[1], found->rgb[2]));
        out.weights.push_back(view_sample_weight(direction));
    }
}

std::array<double, 3> numbers_of(const Vec3f& v) { return {double(v.x()), double(v.y()), double(v.z())}; }

Vec3f vector_of(const std::vector<float>& v) {
    if (v.size() != 3 || !std::ranges::all_of(v, [](float x) { return std::isfinite(x); }))
        throw std::runtime_error("a vector has not three numbers");
    return {v[0], v[1], v[2]};
}

Vec3f mean_up(const Dataset& dataset) {
    Vec3d up = Vec3d::Zero();
    for (const View& view : dataset.views) up -= view.camera.cam_from_world_rotation.row(1).transpose();
    return up.norm() > 1e-6 * double(dataset.views.size()) ? Vec3f(up.normalized().cast<float>()) : Vec3f::UnitY();
}

}  // namespace radiafit
