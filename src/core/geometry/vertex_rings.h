#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace radiafit {

/// Which corner of which triangle a vertex is.
struct Corner {
    uint32_t triangle;
    uint32_t corner;  ///< 0, 1 or 2
};

/// The triangle ring of every vertex: its corners in ascending triangle order. Degenerate triangles are left out;
/// vertices at the rim of a part have none.
class VertexRings {
public:
    /// rims: those of a rim's vertices, too, as far as the part has them.
    explicit VertexRings(const Mesh& mesh, bool rims = false);
    size_t vertex_count() const { return offsets_.size() - 1; }
    std::span<const Corner> ring(size_t vertex) const {
        return {corners_.data() + offsets_[vertex], corners_.data() + offsets_[vertex + 1]};
    }
    const std::vector<uint32_t>& offsets() const { return offsets_; }  ///< [V + 1] into corners()
    const std::vector<Corner>& corners() const { return corners_; }
    size_t max_valence() const;

private:
    std::vector<uint32_t> offsets_;
    std::vector<Corner> corners_;
};

}  // namespace radiafit
