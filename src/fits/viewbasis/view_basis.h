#pragma once
#include <Eigen/Core>
#include <span>

#include "basis/basis_blocks.h"
#include "geometry/mesh.h"
#include "model/prelude.h"

/// Colours of a texel as its cameras see them, without a lamp: functions of the view direction in the texel's frame,
///     y_c(v) = m_c . b(v) + sum over k < rank of z_kc (u_k . b(v)),
/// where b are polynomials, and the means m_c and the basis u_k are learned over the surface, block by block, so that
/// z ~ N(0, I) (empirical Bayes): a texel that few cameras see falls back to what its neighbourhood does.
namespace radiafit::fits {

/// shaders/model/view_basis.glsl.
struct ViewText {
    using real = float;
    using real3 = shared_text::real3_t<float>;
    static float max(float a, float b) { return std::max(a, b); }
#include "model/view_basis.glsl"
};
inline constexpr int view_degree = VIEW_DEGREE, view_terms = VIEW_TERMS, most_rank = view_terms;
static_assert(view_terms == (view_degree + 1) * (view_degree + 2) / 2);
#undef VIEW_DEGREE
#undef VIEW_TERMS

using ViewTerms = Eigen::Matrix<float, view_terms, 1>;

/// b: products T_i(x) T_j(y) of Chebyshev polynomials, i + j <= 6, of a unit direction in a view_frame().
ViewTerms view_polynomials(const Vec3f& direction);

/// What a block of the surface has in common, [28][3 + rank]: the means m_c, then the functions u_k, as columns.
using BlockBasis = Eigen::Matrix<float, view_terms, Eigen::Dynamic, Eigen::RowMajor>;

/// Numbers of each cube: a BlockBasis.
struct ViewBasis : BasisBlocks {
    int rank = 10;
    float noise = 0;  ///< variance of a residual of weight 1
    Vec3f up = Vec3f::UnitY();

    auto block(size_t i) const { return BlockBasis::Map(&numbers[i * block_size()], view_terms, 3 + rank); }
    size_t block_size() const { return size_t(view_terms) * size_t(3 + rank); }
};

}  // namespace radiafit::fits
