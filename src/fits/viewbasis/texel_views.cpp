#include "viewbasis/texel_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace radiafit::fits {

Frame view_frame(const Vec3f& normal, const Vec3f& up) {
    const Vec3f across = up.cross(normal);
    const float length = across.norm();
    if (!(length > 1e-6f)) return make_frame(normal);
    return {across / length, normal.cross(across / length), normal};
}

TexelViewReader::TexelViewReader(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                                 const Vec3f& up)
    : atlas_(&atlas), samples_(&samples), up_(up) {
    for (const uint32_t view : samples.views) eyes_.push_back(dataset.views[view].camera.center().cast<float>());
}

TexelViewReader::Place TexelViewReader::place_of(uint32_t tile, uint32_t local) const {
    const uint32_t texel = tile * atlas_->texels_per_tile() + local;
    return {atlas_->position(texel), view_frame(atlas_->normal(texel), up_)};
}

TexelView TexelViewReader::view_of(const Place& place, uint32_t group, const Sample& sample) const {
    return {view_direction(place.frame, place.position, eyes_[samples_->groups[group].image]),
            samples_->scale * Vec3f(sample.rgb[0], sample.rgb[1], sample.rgb[2])};
}

void TexelViewReader::read(uint32_t tile, uint32_t local, std::vector<TexelView>& out) const {
    out.clear();
    const Place place = place_of(tile, local);
    for (uint32_t g = samples_->tile_groups[tile]; g < samples_->tile_groups[tile + 1]; ++g) {
        const auto group = samples_->of_group(g);
        const auto found = std::ranges::lower_bound(group, local, {}, &Sample::local);
        if (found != group.end() && found->local == local) out.push_back(view_of(place, g, *found));
    }
}

void TexelViewReader::read(uint32_t tile, std::vector<std::vector<TexelView>>& out) const {
    out.resize(atlas_->tile(tile).texels());
    for (auto& views : out) views.clear();
    if (samples_->tile_groups[tile] == samples_->tile_groups[tile + 1]) return;
    std::vector<Place> places;
    for (uint32_t local = 0; local < out.size(); ++local) places.push_back(place_of(tile, local));
    for (uint32_t g = samples_->tile_groups[tile]; g < samples_->tile_groups[tile + 1]; ++g)
        for (const Sample& s : samples_->of_group(g)) out[s.local].push_back(view_of(places[s.local], g, s));
}

Vec3f mean_up(const Dataset& dataset) {
    Vec3d up = Vec3d::Zero();
    for (const View& view : dataset.views) up -= view.camera.cam_from_world_rotation.row(1).transpose();
    return up.norm() > 1e-6 * double(dataset.views.size()) ? Vec3f(up.normalized().cast<float>()) : Vec3f::UnitY();
}

}  // namespace radiafit::fits
