#include "capture/gain_benefit.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/decompositions.h"
#include "base/parallel.h"
#include "base/statistics.h"

namespace radiafit::tools {
namespace {

constexpr size_t judged_points = 600;
constexpr size_t points_for_gains = 4000;  // on both halves
constexpr size_t least_photographs = 3;
constexpr size_t least_seen = 3;  // photographs of a point
constexpr int axes = 3;
constexpr double degree = std::numbers::pi / 180;

/// How logarithms change with the direction: a Gaussian process of variance 1 about a mean that is not known.
struct Smoothness {
    double width;  ///< radians, of exp(-angle^2 / (2 width^2))
    double noise;  ///< variance
};
/// From gloss of some degrees to a slow change, and from what follows it to what takes it for noise.
constexpr std::array smoothnesses = {Smoothness{12 * degree, 0.01}, Smoothness{24 * degree, 0.01},
                                     Smoothness{48 * degree, 0.01}, Smoothness{96 * degree, 0.01},
                                     Smoothness{48 * degree, 100}};
constexpr double unknown_mean = 1e3;  // its variance

using Samples = std::vector<std::vector<GainSample>>;
/// What a training photograph says of a point.
struct Seen {
    uint32_t view;
    Vec3d direction;  ///< to the camera
    Vec3d logs;
};

/// Logarithms of gains [views], and which of them are known.
struct LogGains {
    std::vector<std::array<double, 3>> of_view;
    std::vector<uint8_t> known;

    LogGains(size_t views, const std::optional<KnownGains>& gains) : of_view(views), known(views, 1) {
        if (!gains) return;
        for (size_t v = 0; v < views; ++v)
            for (size_t c = 0; c < 3; ++c) of_view[v][c] = std::log(gains->gains[v][c]);
        for (const size_t v : gains->guessed) known[v] = 0;
    }
};

/// By smoothness: sums of absolute errors.
struct Errors {
    std::array<double, smoothnesses.size()> sums{};
    void operator+=(const Errors& other) {
        for (size_t s = 0; s < sums.size(); ++s) sums[s] += other.sums[s];
    }
    double least() const { return *std::ranges::min_element(sums); }
};

/// Gains that are found on a half of the surface.
struct Found {
    LogGains by_rule, by_other, smooth;
};
/// Without gains, and with each of these.
using Compared = std::array<Errors, 4>;

/// The halves along each axis of the points: 0 or 1.
std::vector<std::array<uint8_t, axes>> halves_of(const GainPoints& points) {
    std::vector<std::array<uint8_t, axes>> out(points.size());
    for (int axis = 0; axis < axes; ++axis) {
        std::vector<double> along;
        for (size_t p = 0; p < points.size(); ++p) along.push_back(points.position(p)[axis]);
        const double middle = median(along);
        for (size_t p = 0; p < points.size(); ++p) out[p][size_t(axis)] = along[p] >= middle;
    }
    return out;
}

/// y minus what the process predicts where all other rows of y are known: (K^-1 y) / diag(K^-1) (Rasmussen and Williams
/// 2006, equation 5.12). squares: of chords between directions.
Eigen::MatrixXd left_out_errors(const Eigen::MatrixXd& squares, const Smoothness& s, const Eigen::MatrixXd& y) {
    Eigen::MatrixXd covariance = (squares.array() * (-0.5 / (s.width * s.width))).exp() + unknown_mean;
    covariance.diagonal().array() += s.noise;
    const Eigen::MatrixXd inverse = inverse_of_definite(covariance);
    return inverse.diagonal().asDiagonal().inverse() * (inverse * y);
}

Eigen::MatrixXd squares_between(const std::vector<Vec3d>& directions) {
    const auto n = Eigen::Index(directions.size());
    Eigen::MatrixXd out(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) out(i, j) = (directions[size_t(i)] - directions[size_t(j)]).squaredNorm();
    return out;
}

/// What the gains of the other photographs predict: a factor common to all points that changes smoothly with the view.
LogGains smoothed(const LogGains& gains, const std::vector<uint8_t>& held_out, const std::vector<Vec3d>& directions) {
    std::vector<size_t> known;
    std::vector<Vec3d> of_known;
    for (size_t v = 0; v < directions.size(); ++v)
        if (gains.known[v] && !held_out[v]) known.push_back(v), of_known.push_back(directions[v]);
    LogGains out = gains;
    if (known.size() < least_photographs) return out;
    Eigen::MatrixXd y(Eigen::Index(known.size()), 3);
    for (size_t i = 0; i < known.size(); ++i)
        for (int c = 0; c < 3; ++c) y(Eigen::Index(i), c) = gains.of_view[known[i]][size_t(c)];
    const Eigen::MatrixXd squares = squares_between(of_known);
    Eigen::MatrixXd best;
    for (const Smoothness& s : smoothnesses) {
        Eigen::MatrixXd off = left_out_errors(squares, s, y);
        if (best.size() == 0 || off.squaredNorm() < best.squaredNorm()) best = std::move(off);
    }
    for (size_t i = 0; i < known.size(); ++i)
        for (int c = 0; c < 3; ++c) out.of_view[known[i]][size_t(c)] -= best(Eigen::Index(i), c);
    return out;
}

class Judged {
public:
    Judged(const GainScene& scene) : scene_(scene), halves_(halves_of(scene.points)), seen_(scene.points.size()) {
        for (uint32_t v = 0; v < scene.samples.size(); ++v)
            for (const GainSample& s : scene.samples[v]) {
                const Vec3d logs = Eigen::Map<const Eigen::Vector3f>(s.log_channels.data()).cast<double>();
                if (scene.held_out[v] || !logs.allFinite()) continue;  // a dark channel
                const Vec3d direction = (scene.eyes[v] - scene.points.position(s.point)).normalized();
                seen_[s.point].push_back({v, direction, logs});
            }
    }

    std::optional<GainBenefit> compare(const GainRule& rule, const GainRule* other) const {
        // What is judged on a half is found on the other one.
        const LogGains none(scene_.samples.size(), {});
        std::vector<Found> found(size_t(2 * axes), {none, none, none});
        const std::vector<Vec3d> directions = directions_of_views();
        parallel_for(found.size(), 1, [&](size_t i, int) {
            const Samples other_half = samples_of(i / 2, 1 - uint8_t(i % 2));
            const LogGains by_rule(scene_.samples.size(), rule(other_half));
            found[i] = {by_rule, other ? LogGains(scene_.samples.size(), (*other)(other_half)) : by_rule,
                        smoothed(by_rule, scene_.held_out, directions)};
        });
        std::vector<Compared> each(scene_.points.size());
        const size_t stride = std::max<size_t>(1, scene_.points.size() / judged_points);
        parallel_for(scene_.points.size() / stride, 4, [&](size_t i, int) {
            const size_t p = i * stride;
            for (size_t axis = 0; axis < axes; ++axis) {
                const auto& [by_rule, by_other, smooth] = found[2 * axis + halves_[p][axis]];
                add(p, by_rule, {&none, &by_rule, &by_other, &smooth}, each[p]);
            }
        });
        Compared sums;
        for (const Compared& c : each)
            for (size_t k = 0; k < sums.size(); ++k) sums[k] += c[k];
        const double without = std::min(sums[0].least(), sums[3].least());
        if (views_judged(found) < least_photographs || !(without > 0)) return {};
        GainBenefit benefit{.lowered = 1 - sums[1].least() / without, .lowered_by_other = {}};
        if (other) benefit.lowered_by_other = 1 - sums[2].least() / without;
        return benefit;
    }

private:
    /// From the middle of the points.
    std::vector<Vec3d> directions_of_views() const {
        Vec3d middle = Vec3d::Zero();
        for (size_t p = 0; p < scene_.points.size(); ++p)
            middle += scene_.points.position(p) / double(scene_.points.size());
        std::vector<Vec3d> out;
        for (const Vec3d& eye : scene_.eyes) out.push_back((eye - middle).normalized());
        return out;
    }

    Samples samples_of(size_t axis, uint8_t half) const {
        const size_t every = std::max<size_t>(1, scene_.points.size() / points_for_gains);
        Samples out(scene_.samples.size());
        for (size_t v = 0; v < out.size(); ++v)
            for (const GainSample& s : scene_.samples[v])
                if (halves_[s.point][axis] == half && s.point % every == 0) out[v].push_back(s);
        return out;
    }

    /// Training photographs whose gain some half tells.
    size_t views_judged(const std::vector<Found>& found) const {
        size_t count = 0;
        for (size_t v = 0; v < scene_.samples.size(); ++v)
            count += !scene_.held_out[v] &&
                     std::ranges::any_of(found, [&](const auto& gains) { return gains.by_rule.known[v] != 0; });
        return count;
    }

    /// Errors at a point of each photograph whose gain `counted` knows, left out and predicted from the others.
    void add(size_t point, const LogGains& counted, const std::array<const LogGains*, 4>& gains,
             Compared& errors) const {
        std::vector<Seen> seen = seen_[point];
        std::erase_if(seen, [&](const Seen& s) { return !counted.known[s.view]; });
        if (seen.size() < least_seen) return;
        const auto n = Eigen::Index(seen.size());
        Eigen::MatrixXd values(n, 3 * gains.size());
        for (Eigen::Index i = 0; i < n; ++i)
            for (size_t k = 0; k < gains.size(); ++k)
                for (int c = 0; c < 3; ++c)
                    values(i, Eigen::Index(3 * k) + c) =
                        seen[size_t(i)].logs[c] + gains[k]->of_view[seen[size_t(i)].view][size_t(c)];
        std::vector<Vec3d> directions;
        for (const Seen& s : seen) directions.push_back(s.direction);
        const Eigen::MatrixXd squares = squares_between(directions);
        for (size_t s = 0; s < smoothnesses.size(); ++s) {
            const Eigen::MatrixXd off = left_out_errors(squares, smoothnesses[s], values);
            for (size_t k = 0; k < gains.size(); ++k)
                errors[k].sums[s] += off.middleCols<3>(Eigen::Index(3 * k)).cwiseAbs().sum();
        }
    }

    const GainScene& scene_;
    std::vector<std::array<uint8_t, axes>> halves_;
    std::vector<std::vector<Seen>> seen_;  ///< [points]
};

}  // namespace

std::optional<GainBenefit> gain_benefit(const GainScene& scene, const GainRule& rule, const GainRule* other) {
    return Judged(scene).compare(rule, other);
}

std::string describe_lowered(double lowered, bool would) {
    return fmt::format("{}{} the error of photographs left out by {:.1f} %", would ? "would " : "",
                       lowered < 0 ? "raise" : "lower", 100 * std::abs(lowered));
}

}  // namespace radiafit::tools
