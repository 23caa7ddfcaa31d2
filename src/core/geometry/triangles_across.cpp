#include "geometry/triangles_across.h"

#include <algorithm>

namespace radiafit {

std::vector<std::array<uint32_t, 3>> triangles_across(const TriangleAtlas& atlas) {
    struct Edge {
        std::array<uint32_t, 2> vertices;
        uint32_t triangle, corner;
    };
    std::vector<Edge> edges;
    const auto& triangles = atlas.mesh().triangles;
    for (uint32_t t = 0; t < triangles.size(); ++t)
        for (uint32_t c = 0; c < 3 && !atlas.degenerate(t); ++c) {
            const auto [low, high] = std::minmax({triangles[t][(c + 1) % 3], triangles[t][(c + 2) % 3]});
            edges.push_back({{low, high}, t, c});
        }
    std::ranges::sort(edges, {}, &Edge::vertices);
    std::vector<std::array<uint32_t, 3>> across(triangles.size(), {no_triangle, no_triangle, no_triangle});
    for (size_t first = 0, end = 0; first < edges.size(); first = end) {
        while (end < edges.size() && edges[end].vertices == edges[first].vertices) ++end;
        if (end != first + 2) continue;
        across[edges[first].triangle][edges[first].corner] = edges[first + 1].triangle;
        across[edges[first + 1].triangle][edges[first + 1].corner] = edges[first].triangle;
    }
    return across;
}

}  // namespace radiafit
