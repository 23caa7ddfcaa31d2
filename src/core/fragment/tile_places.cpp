#include "fragment/tile_places.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "fragment/sls_mesh.h"

namespace radiafit {
namespace {

// The place along a Morton curve over the octahedral map of the normal.
uint32_t facing_key(const Vec3f& normal) {
    const float length = normal.lpNorm<1>();
    if (!(length > 0)) return 0;
    const Vec3f n = normal / length;
    Eigen::Vector2f at = n.head<2>();
    if (n.z() < 0)
        at = {(1 - std::abs(n.y())) * (n.x() < 0 ? -1.0f : 1.0f), (1 - std::abs(n.x())) * (n.y() < 0 ? -1.0f : 1.0f)};
    const auto x = uint32_t((at.x() * 0.5f + 0.5f) * 1023), y = uint32_t((at.y() * 0.5f + 0.5f) * 1023);
    uint32_t key = 0;
    for (int bit = 0; bit < 10; ++bit) key |= (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1);
    return key;
}

}  // namespace

TilePlaces::TilePlaces(const TriangleAtlas& atlas)
    : columns(atlas.rectangles_per_row()),
      rows(2 * (atlas.height() / (atlas.side() + 1))),
      of_tile(atlas.tile_count()) {
    const auto wide = uint32_t(columns);
    const Mesh& mesh = atlas.mesh();
    std::vector<uint32_t> keys(of_tile.size()), sorted(of_tile.size());
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        keys[t] = facing_key((mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]));
    }
    std::iota(sorted.begin(), sorted.end(), 0u);
    std::stable_sort(sorted.begin(), sorted.end(), [&](uint32_t a, uint32_t b) { return keys[a] < keys[b]; });
    // Row pairs, filled two texels at a time: 8 in a row are one vector of 4 x 2 fragments, as llvmpipe shades them.
    for (uint32_t i = 0; i < sorted.size(); ++i) {
        const uint32_t pair = i / (2 * wide), inside = i % (2 * wide);
        of_tile[sorted[i]] = (2 * pair + inside % 2) * wide + inside / 2;
    }
}

TileMarks::TileMarks(TilePlaces places)
    : places_(std::move(places)), texels_(size_t(places_.columns) * size_t(places_.rows)) {
    for (Texture& marks : marks_) marks = Texture(GL_R32UI, places_.columns, places_.rows);
}

void TileMarks::update(const SlsMesh& mesh) {
    turn_ = 1 - turn_;
    std::fill(texels_.begin(), texels_.end(), 0u);
    for (uint32_t tile : mesh.drawn_tiles()) texels_[places_.of_tile[tile]] = tile + 1;
    marks_[turn_].upload_part(places_.columns, places_.rows, GL_RED_INTEGER, GL_UNSIGNED_INT, texels_.data());
}

}  // namespace radiafit
