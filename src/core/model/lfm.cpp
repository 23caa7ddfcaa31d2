#include "model/lfm.h"

#include <cmath>

#include "base/error.h"
#include "model/lfm_text.h"
#include "model/limits.h"

namespace radiafit {

void check_options(const LfmOptions& o) {
    require("terms", o.terms, limits::terms);
    require("surface-side", o.surface_side, limits::map_side);
    require("view-side", o.view_side, limits::map_side);
    require("lambda-surface", double(o.lambda_surface), limits::weight);
    require("lambda-view", double(o.lambda_view), limits::weight);
    require("mu", double(o.mu), limits::weight);
    if (!(std::isfinite(o.lower) && std::isfinite(o.upper) && o.lower < o.upper))
        throw UserError("bounds: the lower must be below the upper");
}

TriangleAtlas surface_atlas(const Mesh& mesh, const LfmOptions& options) {
    return {mesh, options.surface_side, options.sides};
}

LfmLayout::LfmLayout(const VertexRings& rings, const TriangleAtlas& atlas, int view_side, int terms)
    : view_side_(view_side), view_texels_(view_side * view_side), terms_(terms), first_maps_(rings.offsets()) {
    if (const auto& around = atlas.mesh().surroundings; around && !around->blocks.empty())
        whole_offsets_ = {around, &around->blocks};
    offsets_.reserve(rings.vertex_count() + 1);
    offsets_.push_back(0);
    uint32_t triangles = 0;
    for (const Corner& c : rings.corners()) triangles = std::max(triangles, c.triangle + 1);
    map_offsets_.assign(3 * size_t(triangles), no_map);
    for (size_t v = 0; v < rings.vertex_count(); ++v) {
        size_t at = offsets_.back();
        for (const Corner& c : rings.ring(v)) {
            map_offsets_[3 * size_t(c.triangle) + c.corner] = at;
            sides_.push_back(static_cast<uint8_t>(atlas.side(c.triangle)));
            at += TriangleTile::texels_of(sides_.back()) * stride();
        }
        offsets_.push_back(at + size_t(view_texels_) * stride());
    }
}

std::array<double, 2> view_coordinate(const Frame& frame, const Vec3f& position, const Vec3d& camera_center) {
    const Vec3d d = (camera_center - position.cast<double>()).normalized();
    const auto along = [&](const Vec3f& axis) { return axis.cast<double>().dot(d); };
    const auto coordinate =
        LfmText<double>::lfm_view_coordinate({along(frame.tangent), along(frame.bitangent), along(frame.normal)});
    return {coordinate.x, coordinate.y};
}

ViewFootprint view_footprint(const std::array<double, 2>& coordinate, int view_side, ViewLookup lookup) {
    using Text = LfmText<double>;
    const auto [x, y] = coordinate;
    const auto footprint = lookup == ViewLookup::bilinear ? Text::lfm_view_bilinear({x, y}, view_side)
                                                          : Text::lfm_view_nearest({x, y}, view_side);
    const auto w = Text::lfm_view_weights(footprint);
    return {static_cast<uint16_t>(footprint.y * view_side + footprint.x),
            {float(w.x), float(w.y), float(w.z), float(w.w)}};
}

ViewFootprint view_footprint(const Frame& frame, const Vec3f& position, const Vec3d& camera_center, int view_side,
                             ViewLookup lookup) {
    return view_footprint(view_coordinate(frame, position, camera_center), view_side, lookup);
}

double view_weight(const Frame& frame, const Vec3f& position, const Vec3d& camera_center, SampleWeights weights) {
    if (weights == SampleWeights::equal) return 1;
    const Vec3d to_camera = (camera_center - position.cast<double>()).normalized();
    return sample_weight(weights, frame.normal.cast<double>().dot(to_camera));
}

std::string to_string(ViewLookup lookup) { return lookup == ViewLookup::bilinear ? "bilinear" : "nearest"; }
std::string to_string(Mode mode) { return mode == Mode::paper ? "paper" : "modern"; }

}  // namespace radiafit
