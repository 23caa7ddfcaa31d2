#include "lightbasis/reference_lamps.h"

#include <algorithm>
#include <cmath>

#include "dataset/texel_shading.h"
#include "dataset/view_directions.h"
#include "geometry/direction_hull.h"

namespace radiafit::fits {
namespace {

constexpr size_t most_lamps_of_frames = 48;  // where each texel has a frame of its own: lamps are all over the sphere
constexpr size_t most_looked_at = 2000;

std::vector<LampAndHalf> all_lamps(const Dataset& dataset, const std::vector<uint32_t>& views, const LightBasis& basis,
                                   const std::vector<LampValues>& texels) {
    std::vector<LampAndHalf> all;
    if (basis.frame) {
        const TexelShading::Place middle{surface_centre(dataset.mesh, dataset.grid), *basis.frame};
        for (const uint32_t v : views) {
            const TexelShading::Lit lit = TexelShading::lit(middle, dataset.views[v]);
            all.push_back(basis.directions_of(lit.u, lit.v));
        }
    } else {
        for (const LampValues& texel : texels)
            for (const LampAndHalf& at : *texel.directions)
                if (all.size() < most_looked_at) all.push_back(at);
    }
    return all;
}

std::vector<LampAndHalf> spread_lamps(const std::vector<LampAndHalf>& all, size_t count) {
    std::vector<Vec3d> lamps;
    for (const LampAndHalf& at : all) lamps.push_back(at.lamp.cast<double>());
    std::vector<LampAndHalf> out;
    for (const size_t i : spread_over(lamps, count)) out.push_back(all[i]);
    return out;
}

/// With half vectors, one after another, each the one of which those before tell least: pivots of the kernel's Cholesky
/// decomposition (Fine and Scheinberg, JMLR 2001). Fewer where the rest are known by them.
std::vector<LampAndHalf> spread_by_kernel(const std::vector<LampAndHalf>& all, const LightKernel<double>& kernel,
                                          size_t count) {
    constexpr double known = 1e-6;
    const auto n = Eigen::Index(all.size());
    Eigen::MatrixXd factor(n, Eigen::Index(count));
    Eigen::VectorXd left = Eigen::VectorXd::Constant(n, kernel(all[0], all[0]));
    std::vector<LampAndHalf> out;
    for (Eigen::Index k = 0; k < factor.cols(); ++k) {
        Eigen::Index pivot = 0;
        const double most = left.maxCoeff(&pivot);
        if (!(most > known)) break;
        out.push_back(all[size_t(pivot)]);
        Eigen::VectorXd column = -factor.leftCols(k) * factor.row(pivot).head(k).transpose();
        for (Eigen::Index i = 0; i < n; ++i) column[i] += kernel(all[size_t(i)], out.back());
        factor.col(k) = column / std::sqrt(most);
        left -= factor.col(k).cwiseAbs2();
    }
    return out;
}

}  // namespace

std::vector<LampAndHalf> reference_lamps(const Dataset& dataset, const std::vector<uint32_t>& views,
                                         const LightBasis& basis, const ChosenKernel& kernel,
                                         const std::vector<LampValues>& texels) {
    const std::vector<LampAndHalf> all = all_lamps(dataset, views, basis, texels);
    if (all.empty()) return {basis.directions_of(Vec3f::UnitZ(), Vec3f::UnitZ())};
    const size_t most = basis.frame || basis.by_half() ? size_t(most_reference_lamps) : most_lamps_of_frames;
    const size_t count = std::min(all.size(), most);
    return basis.by_half() ? spread_by_kernel(all, kernel, count) : spread_lamps(all, count);
}

}  // namespace radiafit::fits
