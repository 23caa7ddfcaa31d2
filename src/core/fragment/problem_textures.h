#pragma once
#include <array>
#include <vector>

#include "fragment/map_vector.h"

namespace radiafit {

/// M-texel sums: five over samples, in the precision that Sums names, then those over maps, always in 32 bits. They are
/// layers of two arrays (shaders/optimize/vertices.glsl reads them by these numbers).
enum class Sum {
    residual,           ///< sum of r^2 over samples
    gauss_newton,       ///< sum of a^2 over samples
    curvature,          ///< sum of a^2 + 2 r b
    third,              ///< sum of a b
    fourth,             ///< sum of b^2
    penalty,            ///< lambda E_r + mu E_b
    penalty_curvature,  ///< of the penalties along d
    target,             ///< sum of L t; alpha: samples
    count
};

/// M-texel textures: one texel per vertex, r, g, b its three problems. Their numbers are elsewhere: ProblemNumbers.
class ProblemTextures {
public:
    ProblemTextures(const MapShape& shape, Sums sums);
    const Framebuffer& sum_target(Sum sum) const { return sum_targets_[size_t(sum)]; }
    void clear(std::initializer_list<Sum> sums) const {
        for (Sum s : sums) sum_target(s).clear();
    }
    /// Dot products, so many.
    void make_products(int count);
    const Framebuffer& product_target(int product) const { return product_targets_[size_t(product)]; }
    const Texture& products() const { return products_; }
    /// All that a step reads of a problem but its numbers.
    void bind_to(const Program& step) const {
        step.bind_if_used("map_sums", map_sums_);
        step.bind_if_used("sample_sums", sample_sums_);
        step.bind_if_used("problem_constants", constants);
        step.bind_if_used("products", products_);
    }
    /// [vertices][4]. Waits.
    std::vector<float> read(Sum sum) const;
    std::vector<float> read(const Texture& texture, int layer) const;
    /// [vertices][4] into one layer.
    void write(Texture& texture, int layer, const std::vector<float>& values);

    Texture constants;  ///< 2 layers: (1/S-bar, ring texels), lambda_view
    Texture largest;    ///< largest entry of the fresh preconditioner
    Texture ring;       ///< a ring sum on its way into view maps
    Framebuffer largest_target, ring_target;

private:
    size_t vertices_;
    int columns_, rows_;
    Texture sample_sums_, map_sums_, products_;
    std::vector<Framebuffer> sum_targets_, product_targets_;
};

}  // namespace radiafit
