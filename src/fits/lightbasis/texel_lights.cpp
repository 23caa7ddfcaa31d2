#include "lightbasis/texel_lights.h"

#include <algorithm>
#include <utility>

#include "dataset/view_directions.h"
#include "viewbasis/texel_views.h"

namespace radiafit::fits {

TexelLightReader::TexelLightReader(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                                   const LightBasis& basis, LightUnderneath underneath)
    : dataset_(&dataset), atlas_(&atlas), views_(&views), basis_(&basis), underneath_(std::move(underneath)) {}

void TexelLightReader::read(uint32_t texel, std::span<const TexelRadiance> samples, TexelLights& out) const {
    out.directions.clear();
    out.values.clear();
    if (samples.empty()) return;
    const Vec3f normal = atlas_->normal(texel);
    const TexelShading::Place place{atlas_->position(texel).cast<double>(), basis_->frame_of(normal)};
    const Vec3f own_normal = place.frame.to_local(normal);
    for (const TexelRadiance& s : samples) {
        const View& view = dataset_->views[(*views_)[s.image]];
        const TexelShading::Lit lit = TexelShading::lit(place, view);
        if (!basis_->frame && !(own_normal.dot(lit.u) > 0 && own_normal.dot(lit.v) > 0)) continue;
        Vec3f value = basis_->value_of(Vec3f(s.value[0], s.value[1], s.value[2]), lit.irradiance);
        if (underneath_) value -= basis_->value_of(underneath_(texel, view), lit.irradiance);
        out.directions.push_back(basis_->directions_of(lit.u, lit.v));
        out.values.push_back(value);
    }
}

bool lamps_have_all_colours(const Dataset& dataset) {
    return std::ranges::all_of(dataset.split(false),
                               [&](uint32_t v) { return dataset.views[v].light->intensity.minCoeff() > 0; });
}

bool cameras_move(const Dataset& dataset, const std::vector<uint32_t>& views) {
    constexpr double least = 0.05;  // a chord of the unit sphere
    const Vec3d centre = surface_centre(dataset.mesh, dataset.grid);
    const auto direction_of = [&](uint32_t v) { return dataset.views[v].direction_to_camera(centre); };
    return std::ranges::any_of(
        views, [&](uint32_t v) { return (direction_of(v) - direction_of(views.front())).norm() > least; });
}

void set_frame_and_white(const Dataset& dataset, const std::vector<uint32_t>& views, LightBasis& basis) {
    basis.up = mean_up(dataset);
    if (dataset.has_grid()) {
        const Vec3f right = dataset.grid.right.normalized().cast<float>(),
                    up = -dataset.grid.down.normalized().cast<float>();
        basis.frame = Frame{right, up, dataset.grid.normal().cast<float>()};
    }
    const Vec3d centre = surface_centre(dataset.mesh, dataset.grid);
    Vec3d sum = Vec3d::Zero();
    for (const uint32_t view : views) sum += dataset.views[view].light->irradiance_at(centre);
    for (int c = 0; c < 3; ++c) basis.white[c] = sum[c] > 0 ? float(sum[c] / double(views.size())) : 1.0f;
}

}  // namespace radiafit::fits
