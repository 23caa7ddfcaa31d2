#pragma once
#include "base/journal.h"
#include "base/range.h"
#include "geometry/atlas.h"
#include "viewbasis/texel_views.h"

namespace radiafit::limits {
constexpr Range<int> rank{1, fits::most_rank};
constexpr Range<double> noise_variance{1e-9, 1};
constexpr Range<int> blocks{1, 100000, "1 is one basis for all"};
}  // namespace radiafit::limits

namespace radiafit::fits {

struct ViewBasisOptions {
    int rank = 10;        ///< of the basis, in [1, 28]: 3 x rank numbers per texel
    double noise = 6e-4;  ///< variance of a residual, in units of white
    int blocks = 400;     ///< of the surface with a separate basis each, about so many; 1: one for all
    int rounds = 8;       ///< of expectation and maximization
    int texels = 10000;   ///< that the common basis is learned from; each block's, from 200
};
/// Throws UserError for a value out of range.
void check_options(const ViewBasisOptions& options);

/// By expectation and maximization over texels drawn evenly from the surface: first means and covariance of all
/// polynomial coefficients, for the whole surface, then block by block from there; the basis is what the covariance
/// has of the most variance. The same for any number of threads. It looks at samples of learned_from() alone. `journal`
/// keeps blocks that are finished.
ViewBasis learn_view_basis(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                           const ViewBasisOptions& options, Journal* journal = nullptr);

/// [texel_count()] The texels that it looks at. Whatever the size of the surface, they are no more than
/// most_learned_from().
std::vector<bool> learned_from(const TriangleAtlas& atlas, const ViewBasisOptions& options);
uint64_t most_learned_from(const ViewBasisOptions& options);  ///< about so many
/// Bytes that learning holds beyond samples, about.
uint64_t learning_bytes(const TriangleAtlas& atlas, const ViewBasisOptions& options);

}  // namespace radiafit::fits
