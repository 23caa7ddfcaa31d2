#pragma once
#include <vector>

#include "base/journal.h"
#include "viewbasis/texel_views.h"

namespace radiafit {

struct ViewBasisSolution {
    std::vector<float> parameters;  ///< z: [texels][rank][3]; 0 where nothing was seen, which is the mean
    std::vector<uint32_t> samples;  ///< [texels]
    std::vector<float> error;       ///< [texels] 1/2 sum r^2
};

/// Of every texel the z of least
///     sum over samples of w |y - m . b - z . (u . b)|^2 + noise |z|^2,
/// which is the mean of what prior and samples say of z, by Cholesky's decomposition of one matrix for the three
/// channels. All arguments as learn_view_basis() had them. `journal` keeps triangles that are finished.
ViewBasisSolution solve_view_basis(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                                   const ViewBasis& basis, Journal* journal = nullptr);

}  // namespace radiafit
