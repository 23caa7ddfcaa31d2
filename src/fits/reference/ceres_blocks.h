#pragma once
#include <memory>
#include <span>
#include <vector>

#include "reference/lfm_vertex.h"

namespace ceres {
class CostFunction;
class Problem;
}  // namespace ceres

namespace radiafit::fits {

/// What a parameter block is. Smoothness couples the texels of a surface map, so only whole maps can be eliminated
/// exactly, at the price of Jacobians with a map's width; texels are what leaves no zero in a Jacobian.
enum class CeresBlocks { texels, maps };

/// E_t of one vertex as a ceres::Problem: built once, solved for one channel after another.
///     samples that share a surface texel (or map) and the four view texels of a look-up: sqrt(1/S-bar) r
///     texels: sqrt(lambda) (L p)_k per term k, and sqrt(mu) dist(p, [a, b])
/// Parameters x [texels][term] in LfmVertex's order, of one channel.
class CeresVertex {
public:
    CeresVertex(const LfmVertex& vertex, CeresBlocks blocks);
    ~CeresVertex();

    /// From now on the residuals are those of channel c.
    void set_channel(int c);
    ceres::Problem& problem() { return *problem_; }
    std::span<double> x() { return x_; }
    /// The blocks of surface parameters (to be eliminated first) and of view parameters.
    const std::vector<double*>& surface() const { return surface_; }
    const std::vector<double*>& view() const { return view_; }

    struct Channel;

private:
    void add_samples(const LfmVertex& vertex, CeresBlocks blocks);
    void add_penalties(const LfmVertex& vertex, CeresBlocks blocks);
    void add(std::unique_ptr<ceres::CostFunction> cost, const std::vector<double*>& parameters);

    const LfmVertex* vertex_;
    std::unique_ptr<Channel> channel_;
    std::vector<double> x_;
    std::vector<double*> surface_, view_;
    std::vector<std::unique_ptr<ceres::CostFunction>> costs_;
    std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace radiafit::fits
