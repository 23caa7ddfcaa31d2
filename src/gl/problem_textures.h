#pragma once
#include <array>
#include <vector>

#include "gl/map_vector.h"

namespace radiafit {

/// M-texel sums: five over samples, in the precision that Sums names, then those over maps, always in 32 bits. They are
/// layers of two arrays (shaders/optimize/state.glsl reads them by these numbers).
enum class Sum {
    residual,           ///< sum of r^2 over samples
    gauss_newton,       ///< sum of a^2 over samples
    curvature,          ///< sum of a^2 + 2 r b
    third,              ///< sum of a b
    fourth,             ///< sum of b^2
    penalty,            ///< lambda E_r + mu E_b
    norm,               ///< z'.g'
    cross,              ///< z'.g
    conjugate,          ///< d.g'
    penalty_curvature,  ///< of the penalties along d
    target,             ///< sum of L t; alpha: samples
    count
};

/// M-texel textures: one texel per vertex, r, g, b its three problems.
class ProblemTextures {
public:
    ProblemTextures(const MapShape& shape, Sums sums);
    const Framebuffer& sum_target(Sum sum) const { return sum_targets_[size_t(sum)]; }
    void clear(std::initializer_list<Sum> sums) const {
        for (Sum s : sums) sum_target(s).clear();
    }
    void bind_sums() const {
        sample_sums_.bind(8);
        map_sums_.bind(9);
    }
    /// [vertices][4]. Waits.
    std::vector<float> read(Sum sum) const;
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
    Texture sample_sums_, map_sums_;
    std::vector<Framebuffer> sum_targets_;
};

}  // namespace radiafit
