#include "geometry/vertex_rings.h"

#include <algorithm>

namespace radiafit {

// A counting sort by vertex; visiting triangles in order keeps each ring ascending.
VertexRings::VertexRings(const Mesh& mesh, bool rims) : offsets_(mesh.vertex_count() + 1, 0) {
    const uint32_t triangles = static_cast<uint32_t>(mesh.triangle_count());
    const auto has_ring = [&](uint32_t v) { return rims || !mesh.surroundings || !mesh.surroundings->rim[v]; };
    std::vector<uint8_t> skip(triangles);
    for (uint32_t t = 0; t < triangles; ++t) {
        skip[t] = is_degenerate(mesh, t);
        if (skip[t]) continue;
        for (const uint32_t v : mesh.triangles[t]) offsets_[v + 1] += has_ring(v);
    }
    for (size_t v = 1; v < offsets_.size(); ++v) offsets_[v] += offsets_[v - 1];

    corners_.resize(offsets_.back());
    std::vector<uint32_t> next(offsets_.begin(), offsets_.end() - 1);
    for (uint32_t t = 0; t < triangles; ++t) {
        if (skip[t]) continue;
        for (uint32_t c = 0; c < 3; ++c)
            if (const uint32_t v = mesh.triangles[t][c]; has_ring(v)) corners_[next[v]++] = {t, c};
    }
}

size_t VertexRings::max_valence() const {
    size_t valence = 0;
    for (size_t v = 0; v < vertex_count(); ++v) valence = std::max(valence, ring(v).size());
    return valence;
}

}  // namespace radiafit
