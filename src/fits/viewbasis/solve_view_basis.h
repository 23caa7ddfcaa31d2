#pragma once
#include "base/journal.h"
#include "viewbasis/texel_views.h"
#include "viewbasis/view_basis.h"

namespace radiafit::fits {

struct ViewBasisSolution {
    std::vector<float> parameters;  ///< z: [texels][rank][3]; 0 where nothing was seen, which is the mean
    std::vector<uint32_t> samples;  ///< [texels]
    std::vector<float> error;       ///< [texels] 1/2 sum r^2

    ViewBasisSolution(size_t texels, int rank)
        : parameters(texels * size_t(rank) * 3), samples(texels), error(texels) {}
};

/// For every texel the z of least
///     sum over samples of w |y - m . b - z . (u . b)|^2 + noise |z|^2,
/// which is the mean of what prior and samples say of z, by Cholesky's decomposition of one matrix for the three
/// channels. All arguments as learn_view_basis() had them. `journal` keeps triangles that are finished.
ViewBasisSolution solve_view_basis(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                                   const ViewBasis& basis, Journal* journal = nullptr);
/// The same by compute shaders of the current context, for some tiles at a time; it takes seconds, and keeps nothing.
ViewBasisSolution solve_on_device(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                                  const ViewBasis& basis);
}  // namespace radiafit::fits
