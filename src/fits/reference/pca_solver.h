#pragma once
#include <functional>
#include <span>
#include <vector>

#include "model/lfm.h"
#include "reference/ring_resampler.h"

namespace radiafit::fits {

struct PcaFit {
    std::vector<float> parameters;  ///< LfmLayout's order
    ResamplingCounts resampling;    ///< over all vertices that some image sees
};

/// Light field mapping by matrix factorization, as in Chen et al. 2002 ("Light Field Mapping"). Every vertex's ring is
/// resampled to a dense matrix for each channel and factorized by a truncated, uncentred singular value decomposition,
/// joint over the ring, so that its triangles share view maps. A vertex that no image sees keeps zeros.
/// refills: how often invented entries are set to what the terms say there and the factorization is refined on it; 0
/// is the published method, with invented entries as RingResampler leaves them. Of several, ascending, each has a fit
/// of its own from one resampling. vertex_done is called after every vertex, from any thread.
std::vector<PcaFit> pca_solver(const RingResampler& resampler, const LfmLayout& layout, std::span<const int> refills,
                               const std::function<void()>& vertex_done = {});

}  // namespace radiafit::fits
