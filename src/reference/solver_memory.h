#pragma once
#include <cstdint>
#include <string>

#include "model/lfm.h"

/// Memory that the solvers of one vertex after another take for a vertex, reckoned from above before any is taken.
namespace radiafit {

/// The largest problem of a mesh.
struct VertexShape {
    size_t maps = 0;     ///< surface maps: triangles of the vertex's ring
    size_t samples = 0;  ///< of all of them; may be an estimate
};

/// Bytes that a thread takes at its fullest, beside the parameters and the list of samples. `setting`: one of
/// ceres_settings().
uint64_t als_bytes(const LfmOptions& model, const VertexShape& vertex);
uint64_t varpro_bytes(const LfmOptions& model, const VertexShape& vertex);
uint64_t ceres_bytes(const LfmOptions& model, const VertexShape& vertex, const std::string& setting);
uint64_t pca_bytes(const LfmOptions& model, const VertexShape& vertex);

}  // namespace radiafit
