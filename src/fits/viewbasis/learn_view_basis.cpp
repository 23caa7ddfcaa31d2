#include "viewbasis/learn_view_basis.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/range.h"
#include "viewbasis/basis_texels.h"

namespace radiafit::fits {
namespace {

using Matrix = Eigen::Matrix<double, view_terms, view_terms>;
using Means = Eigen::Matrix<double, view_terms, 3>;

constexpr double common_texels = 100;  // that the common prior counts for in a block's covariance
constexpr size_t texels_at_once = 64;  // whose sums are made one after another

/// The distribution of a texel's polynomial coefficients, in each channel: N(mean, covariance).
struct Prior {
    Means mean = Means::Zero();
    Matrix covariance = Matrix::Identity();
};

/// Before anything is known: smooth functions, those of higher degree smaller.
Prior vague_prior() {
    Prior prior;
    prior.mean.row(0).setConstant(0.5);
    int at = 0;
    for (int degree = 0; degree <= view_degree; ++degree)
        for (int j = 0; j <= degree; ++j) prior.covariance(at, at) = std::pow(0.2 / (1 + degree * degree), 2), ++at;
    return prior;
}

/// Sums over texels of what the next prior is made from.
struct Moments {
    double texels = 0;
    Means mean = Means::Zero();
    Matrix covariance = Matrix::Zero();  ///< around the last prior's mean, the three channels added up
    Matrix directions = Matrix::Zero();  ///< sum over samples of w b b'
    double weight = 0;                   ///< of samples
    void add(const Moments& other) {
        texels += other.texels;
        mean += other.mean;
        covariance += other.covariance;
        directions += other.directions;
        weight += other.weight;
    }
};

/// Expectation: adds what the prior and a texel's samples say of its coefficients.
class Expectation {
public:
    Expectation(const Prior& prior, double noise)
        : prior_(prior), noise_(noise), precision_(prior.covariance.llt().solve(Matrix::Identity())) {}

    void add(std::span<const TexelView> views, Moments& sums) const {
        Matrix seen = Matrix::Zero();
        Means right = Means::Zero();
        for (const TexelView& view : views) {
            const Eigen::Matrix<double, view_terms, 1> b = view_polynomials(view.direction).cast<double>();
            const double weight = double(view_sample_weight(view.direction));
            seen.noalias() += weight * b * b.transpose();
            right.noalias() += weight * b * (view.colour.cast<double>() - prior_.mean.transpose() * b).transpose();
            sums.weight += weight;
        }
        sums.directions += seen;
        const Eigen::LLT<Matrix> posterior(precision_ + seen / noise_);
        const Means offset = posterior.solve(right / noise_);
        sums.texels += 1;
        sums.mean += offset;
        sums.covariance += 3 * posterior.solve(Matrix::Identity()) + offset * offset.transpose();
    }

private:
    const Prior& prior_;
    double noise_;
    Matrix precision_;
};

/// Maximization. `common`, if given, counts as `common_texels` more texels.
Prior maximized(const Prior& last, const Moments& sums, const Prior* common) {
    const double own = sums.texels, borrowed = common ? common_texels : 0;
    if (own + borrowed == 0) return last;
    Prior next;
    const Means offset = sums.mean / (own + 0.1 * borrowed);  // a mean needs fewer texels than a covariance
    next.mean = last.mean + offset;
    Matrix covariance = sums.covariance / 3 - own * offset * offset.transpose() / 3;
    if (common) covariance += borrowed * common->covariance;
    covariance /= own + borrowed;
    next.covariance = 0.5 * (covariance + covariance.transpose()) + 1e-12 * covariance.trace() * Matrix::Identity();
    return next;
}

/// The functions of most variance over the directions that were seen.
BlockBasis basis_of(const Prior& prior, const Moments& sums, int rank) {
    const Matrix root = prior.covariance.llt().matrixL();
    const Matrix seen = sums.weight > 0 ? Matrix(sums.directions / sums.weight) : Matrix::Identity();
    const Eigen::SelfAdjointEigenSolver<Matrix> spectrum(root.transpose() * seen * root);
    BlockBasis out(view_terms, 3 + rank);
    out << prior.mean.cast<float>(), (root * spectrum.eigenvectors().rowwise().reverse().leftCols(rank)).cast<float>();
    return out;
}

}  // namespace

void check_options(const ViewBasisOptions& o) {
    radiafit::require("rank", o.rank, limits::rank);
    radiafit::require("noise", o.noise, limits::noise_variance);
    radiafit::require("blocks", o.blocks, limits::blocks);
}

std::vector<bool> learned_from(const TriangleAtlas& atlas, const ViewBasisOptions& options) {
    check_options(options);
    return draw_basis_texels(atlas, size_t(options.texels), options.blocks).mask(atlas);
}

uint64_t most_learned_from(const ViewBasisOptions& options) {
    return uint64_t(options.texels) + texels_per_block * uint64_t(options.blocks);
}

uint64_t learning_bytes(const TriangleAtlas& atlas, const ViewBasisOptions& options) {
    constexpr uint64_t drawing = 144;  // a place, and the numbers that it is drawn by
    return std::min(atlas.used_texels(), most_learned_from(options)) * drawing + atlas.texel_count() / 8 +
           (size_t(options.texels) / texels_at_once + 1) * sizeof(Moments);
}

ViewBasis learn_view_basis(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                           const ViewBasisOptions& options, Journal* journal) {
    check_options(options);
    ViewBasis basis;
    basis.rank = options.rank;
    basis.noise = float(options.noise);
    basis.up = mean_up(dataset);
    const BasisTexels texels = draw_basis_texels(atlas, size_t(options.texels), options.blocks);
    basis.cube = texels.cube;
    basis.origin = texels.origin;
    const TexelViewReader reader(dataset, atlas, samples, basis.up);

    // Sums over chunks of texels, added up in their order.
    const auto moments = [&](const Prior& prior, const std::vector<BasisTexels::Place>& of) {
        std::vector<Moments> parts((of.size() + texels_at_once - 1) / texels_at_once);
        const Expectation expectation(prior, options.noise);
        parallel_for(parts.size(), 1, [&](size_t part, int) {
            std::vector<TexelView> views;
            for (size_t i = part * texels_at_once; i < std::min(of.size(), (part + 1) * texels_at_once); ++i) {
                reader.read(of[i].tile, of[i].local, views);
                if (views.size() >= 3) expectation.add(views, parts[part]);
            }
        });
        Moments sums;
        for (const Moments& part : parts) sums.add(part);
        return sums;
    };
    Prior common = vague_prior();
    for (int round = 0; round < options.rounds; ++round)
        common = maximized(common, moments(common, texels.everywhere), nullptr);
    const bool one_for_all = texels.of_block.empty();
    basis.cubes = texels.cubes;
    basis.numbers.resize(basis.cubes.size() * basis.block_size());
    const auto numbers_of = [&](size_t block) {
        return std::span(basis.numbers).subspan(block * basis.block_size(), basis.block_size());
    };
    finish_blocks(
        journal, basis.cubes.size(), [&](auto& visit, size_t block) { visit(numbers_of(block)); },
        [&](size_t block, int) {
            const auto& of = one_for_all ? texels.everywhere : texels.of_block[block];
            Prior prior = common;
            for (int round = 0; round < options.rounds && !one_for_all; ++round)
                prior = maximized(prior, moments(prior, of), &common);
            BlockBasis::Map(numbers_of(block).data(), view_terms, 3 + options.rank) =
                basis_of(prior, moments(prior, of), options.rank);
        });
    return basis;
}

}  // namespace radiafit::fits
