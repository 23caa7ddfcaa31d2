#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/atlas.h"

namespace radiafit {

/// How what a surface's texels hold is looked up between their centres.
enum class SurfaceLookup {
    nearest,  ///< the texel that the point falls in
    linear    ///< piecewise linear between texels' centres
};
std::string to_string(SurfaceLookup lookup);
/// Throws std::runtime_error for a name that is none.
SurfaceLookup surface_lookup_of(const std::string& name);

/// Texels and what they weigh at a point of the surface: three mostly, of positive weights whose sum is 1.
class TexelMix {
public:
    struct Entry {
        uint32_t triangle, local;
        float weight;
    };
    void add(uint32_t triangle, uint32_t local, float weight) {
        if (weight > 0) entries_[size_t(count_++)] = {triangle, local, weight};
    }
    std::span<const Entry> entries() const { return {entries_.data(), size_t(count_)}; }

private:
    int count_ = 0;
    std::array<Entry, 9> entries_;  // of three tiles, three each
};

/// Which texels a point of the surface shows. Linear: the centres of a tile's texels, i across and j up, are joined to
/// triangles (i, j), (i + 1, j), (i, j + 1) and (i + 1, j + 1), (i, j + 1), (i + 1, j), and colours are linear in each
/// of these. Beyond the outermost centres, half a texel from the edges, the nearest point between these and that of the
/// triangle across the edge are mixed, half and half on the edge itself, so that the look-up is continuous over the
/// surface but at vertices.
class TexelLookup {
public:
    /// The atlas must outlive it.
    TexelLookup(const TriangleAtlas& atlas, SurfaceLookup lookup);
    /// At barycentric (b1, b2), as RasterPixel has them.
    TexelMix at(uint32_t triangle, float b1, float b2) const;

private:
    const TriangleAtlas* atlas_;
    SurfaceLookup lookup_;
    /// [triangles][3]: across the edge that is opposite to a corner; no_triangle: none, or several.
    std::vector<std::array<uint32_t, 3>> across_;
};

}  // namespace radiafit
