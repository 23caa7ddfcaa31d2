#include "viewbasis/learn_view_basis.h"

#include <algorithm>
#include <cmath>

#include "base/range.h"
#include "basis/coefficient_prior.h"

namespace radiafit::fits {
namespace {

using Prior = CoefficientPrior<view_terms, 3>;  // of a texel's polynomial coefficients in each channel
using Sums = Moments<view_terms, 3>;

constexpr size_t texels_per_block = 200;
constexpr size_t texels_at_once = 64;  // whose sums are made one after another

/// Before anything is known: smooth functions, those of higher degree smaller.
Prior vague_prior() {
    Prior prior{Prior::Vectors::Zero(), Prior::Matrix::Identity()};
    prior.mean.row(0).setConstant(0.5);
    int at = 0;
    for (int degree = 0; degree <= view_degree; ++degree)
        for (int j = 0; j <= degree; ++j) prior.covariance(at, at) = std::pow(0.2 / (1 + degree * degree), 2), ++at;
    return prior;
}

/// Adds what a texel's samples say.
void add_texel(const Expectation<view_terms, 3>& expectation, std::span<const TexelView> views, Sums& sums) {
    Prior::Matrix seen = Prior::Matrix::Zero();
    Prior::Vectors right = Prior::Vectors::Zero();
    for (const TexelView& view : views) {
        const Eigen::Matrix<double, view_terms, 1> b = view_polynomials(view.direction).cast<double>();
        const double weight = double(view_sample_weight(view.direction));
        seen.noalias() += weight * b * b.transpose();
        right.noalias() +=
            weight * b * (view.colour.cast<double>() - expectation.prior().mean.transpose() * b).transpose();
        sums.weight += weight;
    }
    expectation.add_by_coefficients(seen, right, sums);
}

BasisTexels drawn_texels(const TriangleAtlas& atlas, const ViewBasisOptions& options) {
    return draw_basis_texels(atlas, extent_of(atlas.mesh()), size_t(options.texels), options.blocks, texels_per_block);
}

}  // namespace

void check_options(const ViewBasisOptions& o) {
    radiafit::require("rank", o.rank, limits::rank);
    radiafit::require("noise", o.noise, limits::noise_variance);
    radiafit::require("blocks", o.blocks, limits::blocks);
}

std::vector<bool> learned_from(const TriangleAtlas& atlas, const ViewBasisOptions& options) {
    check_options(options);
    return drawn_texels(atlas, options).mask(atlas);
}

uint64_t most_learned_from(const ViewBasisOptions& options) {
    return uint64_t(options.texels) + texels_per_block * uint64_t(options.blocks);
}

uint64_t learning_bytes(const TriangleAtlas& atlas, const ViewBasisOptions& options) {
    constexpr uint64_t drawing = 144;  // a place, and the numbers that it is drawn by
    return std::min(atlas.used_texels(), most_learned_from(options)) * drawing + atlas.texel_count() / 8 +
           (size_t(options.texels) / texels_at_once + 1) * sizeof(Sums);
}

ViewBasis learn_view_basis(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                           const ViewBasisOptions& options, Journal* journal) {
    check_options(options);
    const BasisTexels texels = drawn_texels(atlas, options);
    ViewBasis basis{texels.blocks};
    basis.rank = options.rank;
    basis.noise = float(options.noise);
    basis.up = mean_up(dataset);
    basis.numbers.resize(basis.cubes.size() * basis.block_size());
    const TexelViewReader reader(dataset, atlas, samples, basis.up);
    const auto numbers = [&](size_t block) {
        return std::span(basis.numbers).subspan(block * basis.block_size(), basis.block_size());
    };
    learn_blocks(
        texels, vague_prior(), options.rounds, journal,
        [&](const Prior& prior, const std::vector<uint32_t>& of) {
            Expectation<view_terms, 3> expectation(prior, options.noise);
            expectation.find_precision();
            return summed<view_terms, 3>(
                of, texels_at_once, view_terms, [&](std::span<const uint32_t> some, Sums& sums) {
                    std::vector<TexelView> views;
                    for (const uint32_t texel : some) {
                        reader.read(texel / atlas.texels_per_tile(), texel % atlas.texels_per_tile(), views);
                        if (views.size() >= 3) add_texel(expectation, views, sums);
                    }
                });
        },
        [&](auto& visit, size_t block) { visit(numbers(block)); },
        [&](size_t block, const Prior& prior, const Sums& sums) {
            auto out = BlockBasis::Map(numbers(block).data(), view_terms, 3 + options.rank);
            out << prior.mean.cast<float>(), functions_of_most_variance(prior, sums, options.rank).cast<float>();
        });
    return basis;
}

}  // namespace radiafit::fits
