#include "geometry/surface_lookup.h"

#include <algorithm>
#include <stdexcept>

#include "geometry/triangles_across.h"

namespace radiafit {
namespace {

using Weights = std::array<float, 3>;  // of a triangle's corners

/// A place in a tile, by the lattice whose corners are the centres of the tile's corner texels. Centres are evenly
/// spaced there; on the triangle those of the halved cells along the diagonal lie a little nearer to the others. Below
/// 0: beyond the outermost centres.
Weights in_lattice(int side, const Weights& at) {
    const auto n = float(side);
    float x = at[1] * n - 0.5f, y = at[2] * n - 0.5f;
    const float shift = std::max(0.0f, x + y - (n - 2)) / 4;
    x += shift;
    y += shift;
    return {(n - 1 - x - y) / (n - 1), x / (n - 1), y / (n - 1)};
}

/// The place, moved between the corners if it lies beyond.
Weights clamped(Weights at) {
    float sum = 0;
    for (float& w : at) sum += w = std::max(0.0f, w);
    for (float& w : at) w /= sum;
    return at;
}

void add_linear(uint32_t triangle, const TriangleTile& tile, const Weights& lattice, float share, TexelMix& out) {
    const int side = tile.side();
    const float x = lattice[1] * float(side - 1), y = lattice[2] * float(side - 1);
    int i = std::clamp(int(x), 0, side - 2), j = std::clamp(int(y), 0, side - 2);
    if (i + j > side - 2) (x - float(i) < y - float(j) ? i : j) -= 1;
    const float u = x - float(i), v = y - float(j);
    const bool near_corner = u + v <= 1 || i + j == side - 2;
    const auto add = [&](int column, int row, float weight) {
        out.add(triangle, tile.local_of_cell(column, row), share * weight);
    };
    add(i + 1, j, near_corner ? u : 1 - v);
    add(i, j + 1, near_corner ? v : 1 - u);
    near_corner ? add(i, j, 1 - u - v) : add(i + 1, j + 1, u + v - 1);
}

}  // namespace

std::string to_string(SurfaceLookup lookup) { return lookup == SurfaceLookup::linear ? "linear" : "nearest"; }

SurfaceLookup surface_lookup_of(const std::string& name) {
    for (const auto lookup : {SurfaceLookup::nearest, SurfaceLookup::linear})
        if (to_string(lookup) == name) return lookup;
    throw std::runtime_error("unknown surface look-up \"" + name + "\"");
}

TexelLookup::TexelLookup(const TriangleAtlas& atlas, SurfaceLookup lookup) : atlas_(&atlas), lookup_(lookup) {
    if (lookup == SurfaceLookup::nearest) return;
    across_ = triangles_across(atlas);
}

TexelMix TexelLookup::at(uint32_t triangle, float b1, float b2) const {
    TexelMix out;
    const int side = atlas_->side(triangle);
    if (lookup_ == SurfaceLookup::nearest) {
        out.add(triangle, atlas_->local_at(triangle, b1, b2), 1);
        return out;
    }
    const Weights at = clamped({1 - b1 - b2, b1, b2}), lattice = in_lattice(side, at);
    Weights beyond{};  // the outermost centres: 0 there, 1 on the edge
    for (size_t c = 0; c < 3; ++c)
        if (const float m = -lattice[c] * float(side - 1); m > 0) beyond[c] = m / (m + at[c] * float(side));
    float own = 1;
    for (uint32_t c = 0; c < 3; ++c) {
        const uint32_t other = across_[triangle][c];
        if (beyond[c] == 0 || other == no_triangle) continue;
        const float next = std::max(beyond[(c + 1) % 3], beyond[(c + 2) % 3]);
        const float share = beyond[c] * (1 - next) / (2 * std::max(1 - beyond[c] * next, 1e-6f));
        Weights on_edge{};
        for (size_t k = 0; k < 3; ++k)
            for (size_t o = 0; o < 3 && k != c; ++o)
                if (atlas_->mesh().triangles[triangle][k] == atlas_->mesh().triangles[other][o]) on_edge[o] = at[k];
        const TriangleTile& tile = atlas_->tile(other);
        add_linear(other, tile, clamped(in_lattice(tile.side(), clamped(on_edge))), share, out);
        own -= share;
    }
    add_linear(triangle, atlas_->tile(triangle), clamped(lattice), own, out);
    return out;
}

}  // namespace radiafit
