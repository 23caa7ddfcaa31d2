#pragma once
#include "base/journal.h"
#include "base/range.h"
#include "basis/basis_texels.h"
#include "lightbasis/texel_lights.h"

namespace radiafit::limits {
constexpr Range<int> light_rank{1, 3 * fits::most_reference_lamps};
}  // namespace radiafit::limits

namespace radiafit::fits {

struct LightBasisOptions {
    int rank = 54;        ///< of the basis, so many numbers per texel; at most three for each reference lamp
    double noise = 3e-4;  ///< variance of a residual on the curve, white being 1
    int blocks = 1;       ///< of the surface with a separate basis each, about so many
    ValueCurve curve = ValueCurve::srgb;
    std::string underneath = "none";  ///< the texel-local model that it adds to
    int rounds = 6;                   ///< of expectation and maximization
    int texels = 4000;                ///< that the common basis is learned from
    int block_texels = 600;           ///< that a block's is
};
/// Throws UserError for a value out of range.
void check_options(const LightBasisOptions& options);

/// So many blocks suit a surface of so many texels.
int light_blocks(const Atlas& atlas);
/// [texel_count()] The texels whose samples learning looks at.
std::vector<bool> learned_from(const Dataset& dataset, const Atlas& atlas, const LightBasisOptions& options);

/// As learn_view_basis(), from the texels' samples under lamps: `source` has those of these views. Where their cameras
/// move, too, its kernel may know half vectors (choose_kernel()).
LightBasis learn_light_basis(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                             const TexelSource& source, const LightBasisOptions& options,
                             const LightUnderneath& underneath = {}, Journal* journal = nullptr);

}  // namespace radiafit::fits
