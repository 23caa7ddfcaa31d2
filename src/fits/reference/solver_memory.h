#pragma once
#include <cstdint>
#include <string>

#include "base/rings.h"
#include "model/lfm.h"

/// Memory that the solvers of one vertex after another take for a vertex, reckoned from above before any is taken.
namespace radiafit::fits {

/// The largest problem of a mesh.
struct VertexShape {
    size_t maps = 0;     ///< surface maps: triangles of the vertex's ring
    size_t samples = 0;  ///< of all of them; may be an estimate
};

/// What Ceres holds of the normal equations, by setting.
enum class CeresMemory { jacobian, sparse_factor, dense_qr, dense_normal, dense_schur, dense_maps, vectors };

/// Bytes that a thread takes at its fullest, beside the parameters and the list of samples.
uint64_t als_bytes(const LfmOptions& model, const VertexShape& vertex);
uint64_t varpro_bytes(const LfmOptions& model, const VertexShape& vertex);
uint64_t ceres_bytes(const LfmOptions& model, const VertexShape& vertex, CeresMemory memory);
uint64_t pca_bytes(const LfmOptions& model, const VertexShape& vertex);

}  // namespace radiafit::fits
