#pragma once
#include <array>
#include <vector>

#include "gl/map_vector.h"

namespace radiafit {

/// Layers of the M-texel sums (shaders/optimize/state.glsl reads them by these numbers).
enum class Sum {
    residual,           ///< sum of r^2 over samples
    penalty,            ///< lambda E_r + mu E_b
    norm,               ///< z'.g'
    cross,              ///< z'.g
    conjugate,          ///< d.g'
    gauss_newton,       ///< sum of a^2 over samples
    curvature,          ///< sum of a^2 + 2 r b
    third,              ///< sum of a b
    fourth,             ///< sum of b^2
    penalty_curvature,  ///< of the penalties along d
    target,             ///< sum of L t; alpha: samples
    count
};

/// M-texel textures: one texel per vertex, r, g, b its three problems.
class ProblemTextures {
public:
    explicit ProblemTextures(const MapShape& shape);
    const Framebuffer& sum_target(Sum sum) const { return sum_targets_[size_t(sum)]; }
    void clear(std::initializer_list<Sum> sums) const {
        for (Sum s : sums) sum_target(s).clear();
    }
    const Texture& sums() const { return sums_; }
    /// One layer of sums or state, [vertices][4]. Waits.
    std::vector<float> read(const Texture& texture, int layer) const;
    /// [vertices][4] into one layer.
    void write(Texture& texture, int layer, const std::vector<float>& values);

    Texture state;      ///< 8 layers: the fields of ProblemState
    Texture alpha;      ///< the step along d, without its factor
    Texture constants;  ///< 2 layers: (1/S-bar, ring texels), lambda_view
    Texture largest;    ///< largest entry of the fresh preconditioner
    Texture ring;       ///< a ring sum on its way into view maps
    Framebuffer state_target, line_target, largest_target, ring_target;

private:
    size_t vertices_;
    int columns_, rows_;
    Texture sums_;
    std::vector<Framebuffer> sum_targets_;
};

}  // namespace radiafit
