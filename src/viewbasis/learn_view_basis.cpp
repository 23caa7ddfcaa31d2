#include "viewbasis/learn_view_basis.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "base/range.h"
#include "base/rng.h"

namespace radiafit {
namespace {

using Matrix = Eigen::Matrix<double, view_terms, view_terms>;
using Means = Eigen::Matrix<double, view_terms, 3>;

constexpr int texels_per_block = 200;
constexpr double common_texels = 100;  // that the common prior counts for in a block's covariance
constexpr uint64_t draw_seed = 1;

/// Of a texel's polynomial coefficients, each channel's: N(mean, covariance).
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

    void add(const TexelViews& views, Moments& sums) const {
        Matrix seen = Matrix::Zero();
        Means right = Means::Zero();
        for (size_t i = 0; i < views.terms.size(); ++i) {
            const Eigen::Matrix<double, view_terms, 1> b = views.terms[i].cast<double>();
            const double weight = double(views.weights[i]);
            seen.noalias() += weight * b * b.transpose();
            right.noalias() += weight * b * (views.colours[i].cast<double>() - prior_.mean.transpose() * b).transpose();
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

/// Maximization. `common`, if given, counts as so many texels of its own.
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
    BlockBasis out;
    out.mean = prior.mean.cast<float>();
    const Matrix root = prior.covariance.llt().matrixL();
    const Matrix seen = sums.weight > 0 ? Matrix(sums.directions / sums.weight) : Matrix::Identity();
    const Eigen::SelfAdjointEigenSolver<Matrix> spectrum(root.transpose() * seen * root);
    out.u = (root * spectrum.eigenvectors().rowwise().reverse().leftCols(rank)).cast<float>();
    return out;
}

struct Place {
    uint32_t tile, local;
};

/// At most `count` of the places, evenly.
std::vector<Place> drawn(std::vector<Place> places, size_t count, uint64_t seed) {
    if (places.size() <= count) return places;
    Rng rng(draw_seed, seed);
    for (size_t i = 0; i < count; ++i) std::swap(places[i], places[i + rng.index(uint32_t(places.size() - i))]);
    places.resize(count);
    return places;
}

/// Usable texels by cube.
std::map<std::array<int32_t, 3>, std::vector<Place>> by_cube(const TriangleAtlas& atlas, const ViewBasis& basis) {
    std::map<std::array<int32_t, 3>, std::vector<Place>> out;
    for (uint32_t t = 0; t < atlas.tile_count(); ++t)
        for (uint32_t l = 0; l < atlas.tile(t).texels() && !atlas.degenerate(t); ++l)
            out[cube_at(atlas.position(t, l), basis.origin, basis.cube)].push_back({t, l});
    return out;
}

/// Side of cubes of which about so many hold some of the surface.
float cube_side(const TriangleAtlas& atlas, int blocks) {
    if (blocks <= 1) return 0;
    double area = 0;
    const Mesh& mesh = atlas.mesh();
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3d origin = mesh.positions[a].cast<double>();
        area +=
            0.5 * (mesh.positions[b].cast<double>() - origin).cross(mesh.positions[c].cast<double>() - origin).norm();
    }
    return float(std::sqrt(1.5 * area / blocks));  // a plane across a cube at random has about 1.5 times a face's area
}

}  // namespace

void check_options(const ViewBasisOptions& o) {
    radiafit::require("rank", o.rank, limits::rank);
    radiafit::require("noise", o.noise, limits::noise_variance);
    radiafit::require("blocks", o.blocks, limits::blocks);
}

ViewBasis learn_view_basis(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                           const ViewBasisOptions& options) {
    check_options(options);
    ViewBasis basis;
    basis.rank = options.rank;
    basis.noise = float(options.noise);
    basis.up = mean_up(dataset);
    basis.cube = cube_side(atlas, options.blocks);
    basis.origin = atlas.mesh().positions.empty() ? Vec3f(Vec3f::Zero()) : atlas.mesh().positions[0];
    for (const Vec3f& p : atlas.mesh().positions) basis.origin = basis.origin.cwiseMin(p);
    const TexelViewReader reader(dataset, atlas, samples, basis.up);
    const auto places = by_cube(atlas, basis);

    // Sums over chunks of texels, added up in their order.
    const auto moments = [&](const Prior& prior, const std::vector<Place>& of) {
        constexpr size_t chunk = 64;
        std::vector<Moments> parts((of.size() + chunk - 1) / chunk);
        const Expectation expectation(prior, options.noise);
        parallel_for(parts.size(), 1, [&](size_t part, int) {
            TexelViews views;
            for (size_t i = part * chunk; i < std::min(of.size(), (part + 1) * chunk); ++i) {
                reader.read(of[i].tile, of[i].local, views);
                if (views.terms.size() >= 3) expectation.add(views, parts[part]);
            }
        });
        Moments sums;
        for (const Moments& part : parts) sums.add(part);
        return sums;
    };
    std::vector<Place> everywhere;
    for (const auto& [cube, all] : places) everywhere.insert(everywhere.end(), all.begin(), all.end());
    everywhere = drawn(std::move(everywhere), size_t(options.texels), 0);
    Prior common = vague_prior();
    for (int round = 0; round < options.rounds; ++round)
        common = maximized(common, moments(common, everywhere), nullptr);
    if (basis.cube == 0 || places.empty()) {
        basis.cubes = {{0, 0, 0}};
        basis.blocks = {basis_of(common, moments(common, everywhere), options.rank)};
        return basis;
    }
    std::vector<std::vector<Place>> of_block;
    for (const auto& [cube, all] : places) {
        basis.cubes.push_back(cube);
        of_block.push_back(drawn(all, texels_per_block, 1 + of_block.size()));
    }
    basis.blocks.resize(of_block.size());
    parallel_for(of_block.size(), 1, [&](size_t block, int) {
        Prior prior = common;
        for (int round = 0; round < options.rounds; ++round)
            prior = maximized(prior, moments(prior, of_block[block]), &common);
        basis.blocks[block] = basis_of(prior, moments(prior, of_block[block]), options.rank);
    });
    return basis;
}

}  // namespace radiafit
