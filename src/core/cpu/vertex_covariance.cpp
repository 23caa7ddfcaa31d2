#include "cpu/vertex_covariance.h"

#include <cmath>
#include <limits>

#include "base/log.h"
#include "base/parallel.h"
#include "cpu/ring_samples.h"
#include "model/covariance.h"
#include "model/influence.h"

namespace radiafit {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr float unknown = std::numeric_limits<float>::infinity();

/// Where a vertex's texels are among the blocks of its matrices.
class Blocks {
public:
    Blocks(const VertexProblem& problem) : terms_(problem.options().terms) {
        for (const int side : problem.sides()) {
            const size_t texels = TriangleTile::texels_of(side);
            sizes_.push_back(Index(texels) * terms_);
            for (size_t local = 0; local < texels; ++local)
                places_.push_back({sizes_.size() - 1, Index(local) * terms_});
        }
        const Index side = problem.options().view_side;
        corner_ = side * side * terms_;
    }
    struct Place {
        size_t block;
        Index first;
    };
    const Place& place(size_t texel) const { return places_[texel]; }
    size_t texels() const { return places_.size(); }
    ArrowMatrix matrix() const { return {sizes_, corner_}; }

private:
    Index terms_, corner_;
    std::vector<Index> sizes_;
    std::vector<Place> places_;
};

/// L^T L of a map (Eq. 9), texel by texel.
MatrixXd smoothness_of(const MapNeighbours& map) {
    MatrixXd once = MatrixXd::Zero(Index(map.texel_count()), Index(map.texel_count()));
    for (size_t i = 0; i < map.texel_count(); ++i)
        for (const size_t j : map.of(i)) {
            once(Index(i), Index(i)) += 1;
            once(Index(i), Index(j)) -= 1;
        }
    return once.transpose() * once;
}
/// Adds the smoothness to each term of a map whose unknowns are ordered [texel][term].
void add_to_terms(MatrixXd& to, const MatrixXd& smoothness, int terms, double factor) {
    for (Index i = 0; i < smoothness.rows(); ++i)
        for (Index j = 0; j < smoothness.cols(); ++j)
            for (Index k = 0; k < terms; ++k) to(i * terms + k, j * terms + k) += factor * smoothness(i, j);
}

/// One channel of a vertex at its optimum.
class Problem {
public:
    Problem(const VertexProblem& problem, std::span<const Lanes<float>> x, int channel)
        : problem_(problem), options_(problem.options()), x_(x), channel_(channel), terms_(options_.terms) {}

    double value(size_t at) const { return double(x_[at][channel_]); }
    double surface(size_t texel, Index k) const { return value(texel * size_t(terms_) + size_t(k)); }
    /// Four view texels of a look-up and their weights.
    struct LookUp {
        std::array<Index, 4> texel;
        std::array<double, 4> weight;
    };
    LookUp look_up(Index texel, const float* weight) const {
        const Index side = options_.view_side;
        LookUp out{{texel, texel + 1, texel + side, texel + side + 1}, {}};
        for (size_t q = 0; q < 4; ++q) {
            out.weight[q] = double(weight[q]);
            if (weight[q] == 0) out.texel[q] = texel;  // none may be there
        }
        return out;
    }
    double view(const LookUp& look_up, Index k) const {
        double sum = 0;
        for (size_t q = 0; q < 4; ++q)
            sum +=
                look_up.weight[q] * value((problem_.texels(0) + size_t(look_up.texel[q])) * size_t(terms_) + size_t(k));
        return sum;
    }
    /// [terms] derivatives by the texel's unknowns, and [4][terms] by those of the look-up's view texels.
    void row(size_t texel, const LookUp& at, VectorXd& by_surface, VectorXd& by_view) const {
        by_surface.resize(terms_);
        by_view.resize(4 * terms_);
        for (Index k = 0; k < terms_; ++k) {
            by_surface[k] = view(at, k);
            for (Index q = 0; q < 4; ++q) by_view[q * terms_ + k] = at.weight[size_t(q)] * surface(texel, k);
        }
    }

    /// Sums over samples.
    struct Sums {
        ArrowMatrix normal;  ///< J^T W J
        ArrowMatrix noisy;   ///< J^T W Lambda^2 W J
        double squares = 0;  ///< sum of w psi^2
        double lambda = 0;   ///< sum of w Lambda^2
        double slope = 0;    ///< sum of psi'
        double samples = 0;
    };
    Sums sums(const Blocks& blocks) const {
        Sums out{blocks.matrix(), blocks.matrix()};
        VectorXd g, h;
        problem_.for_images([&](const auto& footprint, float sample_weight, const auto& samples) {
            const LookUp at = look_up(footprint.texel, footprint.weight);
            const double w = double(sample_weight);
            for (size_t i = 0; i < samples.size(); ++i) {
                const size_t texel = samples.texel(i);
                row(texel, at, g, h);
                double residual = -double(samples.target(i)[channel_]);
                for (Index k = 0; k < terms_; ++k) residual += g[k] * surface(texel, k);
                const double lambda = double(problem_.lambda(texel)), square = w * residual * residual;
                const Influence influence = influence_of(options_.loss, square, 1);
                out.squares += influence.weight * influence.weight * square;
                out.slope += influence.slope;
                out.lambda += w * lambda * lambda;
                ++out.samples;
                add(out.normal, blocks.place(texel), at, g, h, w);
                add(out.noisy, blocks.place(texel), at, g, h, w * w * lambda * lambda);
            }
        });
        return out;
    }
    /// Curvature of the penalties, in units of the sum over samples.
    ArrowMatrix known(const Blocks& blocks) const {
        ArrowMatrix out = blocks.matrix();
        const double density = 1 / double(problem_.scale().inverse_density);
        for (size_t b = 0; b < out.blocks.size(); ++b)
            add_to_terms(out.blocks[b], smoothness_of(MapNeighbours::triangle(problem_.sides()[b])), int(terms_),
                         density * double(options_.lambda_surface));
        add_to_terms(out.corner, smoothness_of(MapNeighbours::square(options_.view_side)), int(terms_),
                     density * double(problem_.scale().lambda_view[channel_]));
        const auto bound = [&](double& diagonal, double p) {
            diagonal +=
                density * ObjectiveText<double>::bound_curvature(p, 1, double(options_.lower), double(options_.upper),
                                                                 double(options_.mu), options_.mode == Mode::paper);
        };
        for (size_t texel = 0; texel < blocks.texels(); ++texel) {
            const auto [block, first] = blocks.place(texel);
            bound(out.blocks[block](first, first), surface(texel, 0));
        }
        const size_t begin = problem_.texels(0) * size_t(terms_);
        for (Index i = 0; i < out.corner.rows(); i += terms_) bound(out.corner(i, i), value(begin + size_t(i)));
        return out;
    }
    /// [corner][K^2] changes of the view map by h X.
    MatrixXd gauge() const {
        const Index view_texels = Index(options_.view_side) * options_.view_side;
        MatrixXd out = MatrixXd::Zero(view_texels * terms_, terms_ * terms_);
        const size_t begin = problem_.texels(0) * size_t(terms_);
        for (Index j = 0; j < view_texels; ++j)
            for (Index from = 0; from < terms_; ++from)
                for (Index to = 0; to < terms_; ++to)
                    out(j * terms_ + to, from * terms_ + to) = value(begin + size_t(j * terms_ + from));
        return out;
    }

private:
    void add(ArrowMatrix& to, const Blocks::Place& place, const LookUp& at, const VectorXd& g, const VectorXd& h,
             double weight) const {
        MatrixXd &block = to.blocks[place.block], &border = to.borders[place.block];
        for (Index k = 0; k < terms_; ++k)
            for (Index j = 0; j < terms_; ++j) block(place.first + k, place.first + j) += weight * g[k] * g[j];
        for (Index q = 0; q < 4; ++q)
            for (Index k = 0; k < terms_; ++k) {
                const Index column = at.texel[size_t(q)] * terms_ + k;
                const double of_view = weight * h[q * terms_ + k];
                for (Index j = 0; j < terms_; ++j) border(place.first + j, column) += of_view * g[j];
                for (Index r = 0; r < 4; ++r)
                    for (Index j = 0; j < terms_; ++j)
                        to.corner(at.texel[size_t(r)] * terms_ + j, column) += of_view * h[r * terms_ + j];
            }
    }

    const VertexProblem& problem_;
    const LfmOptions& options_;
    std::span<const Lanes<float>> x_;
    int channel_;
    Index terms_;
};

/// [surface texels, then view texels][term]: the vertex's block, as LfmLayout has it.
template <class Body>
void for_diagonal(const ArrowMatrix& m, const Body& body) {
    size_t at = 0;
    for (size_t b = 0; b < m.blocks.size(); ++b)
        for (Index i = 0; i < m.blocks[b].rows(); ++i) body(at++, b, i);
    for (Index i = 0; i < m.corner.rows(); ++i) body(at++, m.blocks.size(), i);
}
double diagonal_of(const ArrowMatrix& m, size_t block, Index i) {
    return block < m.blocks.size() ? m.blocks[block](i, i) : m.corner(i, i);
}

}  // namespace

ProblemErrorBars problem_error_bars(const VertexProblem& vertex, std::span<const Lanes<float>> x, int channel) {
    const Blocks blocks(vertex);
    const Problem problem(vertex, x, channel);
    Problem::Sums sums = problem.sums(blocks);
    constexpr double least_slope = 1e-2;  // where a robust loss finds nothing but outliers
    const double slope = std::max(least_slope, sums.slope / sums.samples);
    const ArrowMatrix curvature = problem.known(blocks).add(sums.normal, slope);
    const ArrowInverse inverse(curvature, problem.gauge());
    ProblemErrorBars out{inverse.inverse(), {}, 0, inverse.deficient()};
    const double left = sums.samples - slope * out.covariance.product_trace(sums.normal);
    for_diagonal(out.covariance, [&](size_t, size_t block, Index i) {
        const double alone = diagonal_of(curvature, block, i),
                     inflation = alone * diagonal_of(out.covariance, block, i);
        out.deviation.push_back(left >= 1 && alone > 0 && inflation <= most_inflation ? 0 : unknown);
    });
    if (left < 1) return out;
    const double residual = sums.squares / left, pixel = residual * sums.samples / sums.lambda;
    out.noise = std::sqrt(pixel) / slope;
    // what was known beforehand is as uncertain as its curvature says beside that of the samples
    ArrowMatrix pulls = blocks.matrix();
    pulls.add(inverse.matrix(), residual / slope).add(sums.normal, -residual).add(sums.noisy, pixel);
    out.covariance = inverse.around(pulls);
    for_diagonal(out.covariance, [&](size_t at, size_t block, Index i) {
        if (out.deviation[at] == 0)
            out.deviation[at] = float(std::sqrt(std::max(0.0, diagonal_of(out.covariance, block, i))));
    });
    return out;
}

AllVertexErrorBars::AllVertexErrorBars(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                                       const SampleList& samples, const LfmOptions& options,
                                       std::span<const float> parameters, std::span<const Vec3d> eyes)
    : atlas_(&atlas),
      options_(options),
      layout_(rings, atlas, options.view_side, options.terms),
      frames_(vertex_frames(dataset.mesh)),
      eyes_(eyes.begin(), eyes.end()) {
    const size_t vertices = layout_.problem_count();
    deviation.resize(layout_.size());
    noise.resize(3 * vertices);
    deficient.resize(3 * vertices);
    values_.resize(eyes_.size() * texels() * 3);
    const ProblemStatistics statistics = count_rings(rings, samples, TargetWeights<float>(atlas, samples.scale));
    const VertexProblem fresh(dataset, atlas, rings, samples.views, options);
    Progress progress("error bars", vertices);
    parallel_for(vertices, 1, [&](size_t v, int) {
        progress.advance();
        if (statistics.samples[v] == 0) return;
        VertexProblem problem = fresh;
        problem.load(v, samples, &statistics.mean[3 * v]);
        std::vector<Lanes<float>> x(layout_.block_size(v) / 4);
        set_lanes<float>(parameters.subspan(layout_.offset(v), layout_.block_size(v)), x.data());
        for (int channel = 0; channel < 3; ++channel) take(v, problem, x, channel);
    });
    progress.finish();
}

void AllVertexErrorBars::take(size_t v, const VertexProblem& vertex, std::span<const Lanes<float>> x, int channel) {
    const ProblemErrorBars bars = problem_error_bars(vertex, x, channel);
    const size_t offset = layout_.offset(v);
    for (size_t i = 0; i < bars.deviation.size(); ++i) deviation[offset + 4 * i + size_t(channel)] = bars.deviation[i];
    noise[3 * v + size_t(channel)] = float(bars.noise);
    deficient[3 * v + size_t(channel)] = uint32_t(bars.deficient);

    const Blocks blocks(vertex);
    const Problem problem(vertex, x, channel);
    const Index terms = options_.terms;
    VectorXd g, h;
    for (size_t eye = 0; eye < eyes_.size(); ++eye) {
        const ViewFootprint seen =
            view_footprint(frames_[v], atlas_->mesh().positions[v], eyes_[eye], options_.view_side, options_.lookup);
        const Problem::LookUp at = problem.look_up(seen.texel, seen.weight);
        std::vector<Index> columns;
        for (const Index texel : at.texel)
            for (Index k = 0; k < terms; ++k) columns.push_back(texel * terms + k);
        const MatrixXd corner = bars.covariance.corner(columns, columns);
        for (size_t texel = 0; texel < blocks.texels(); ++texel) {
            const auto [block, first] = blocks.place(texel);
            problem.row(texel, at, g, h);
            const double variance = g.dot(bars.covariance.blocks[block].block(first, first, terms, terms) * g) +
                                    2 * g.dot(bars.covariance.borders[block](Eigen::seqN(first, terms), columns) * h) +
                                    h.dot(corner * h);
            values_[3 * (eye * texels() + offset / layout_.stride() + texel) + size_t(channel)] =
                bars.noise > 0 ? float(std::sqrt(std::max(0.0, variance))) : unknown;
        }
    }
}

Vec3f AllVertexErrorBars::of_value(size_t eye, uint32_t triangle, uint32_t local) const {
    Vec3f sum = Vec3f::Zero();
    for (uint32_t corner = 0; corner < 3; ++corner) {
        const size_t map = layout_.map_offset(triangle, corner);
        if (map == LfmLayout::no_map) return Vec3f::Constant(unknown);
        sum += Vec3f::Map(&values_[3 * (eye * texels() + map / layout_.stride() + local)]);
    }
    return sum;
}

Vec3f AllVertexErrorBars::noise_at(uint32_t triangle, uint32_t local) const {
    const auto lambda = atlas_->tile(triangle).barycentric(local);
    Vec3f sum = Vec3f::Zero();
    for (size_t corner = 0; corner < 3; ++corner)
        sum += float(lambda[corner]) * Vec3f::Map(&noise[3 * size_t(atlas_->mesh().triangles[triangle][corner])]);
    return sum;
}

}  // namespace radiafit
