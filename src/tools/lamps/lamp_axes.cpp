#include "lamps/lamp_axes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/decompositions.h"
#include "base/parallel.h"
#include "base/statistics.h"

namespace radiafit::tools {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector4d;
using Eigen::VectorXd;

constexpr int tiles_across = 6;

/// Sums over each tile of the images, whose pixels may err together: [tiles].
using TileSums = std::vector<VectorXd>;

size_t tile_of(const LitRelief& relief, const ReliefPixel& p) {
    const int across = p.x * tiles_across / relief.width, down = p.y * tiles_across / relief.height;
    return size_t(down * tiles_across + across);
}

struct Estimate {
    VectorXd value;
    MatrixXd covariance;
};

/// What is reckoned from the sums, and how sure it is by leaving tiles out (jackknife; Efron 1982).
template <class Reckon>
Estimate jackknife(const TileSums& tiles, const Reckon& reckon) {
    VectorXd all = VectorXd::Zero(tiles[0].size());
    for (const VectorXd& tile : tiles) all += tile;
    Estimate out{reckon(all), {}};
    std::vector<VectorXd> without;
    VectorXd mean = VectorXd::Zero(out.value.size());
    for (const VectorXd& tile : tiles) {
        if (tile.isZero(0)) continue;
        without.push_back(reckon(VectorXd(all - tile)));
        mean += without.back();
    }
    out.covariance = MatrixXd::Zero(mean.size(), mean.size());
    if (without.empty()) return out;
    mean /= double(without.size());
    for (const VectorXd& value : without) out.covariance += (value - mean) * (value - mean).transpose();
    out.covariance *= double(without.size() - 1) / double(without.size());
    return out;
}

/// Pixels by tiles.
std::vector<std::vector<uint32_t>> tiled(const LitRelief& relief) {
    std::vector<std::vector<uint32_t>> out(size_t(tiles_across) * tiles_across);
    for (size_t i = 0; i < relief.pixels.size(); ++i) out[tile_of(relief, relief.pixels[i])].push_back(uint32_t(i));
    return out;
}

template <class Add>
TileSums sums(const LitRelief& relief, Eigen::Index size, const Add& add) {
    const auto tiles = tiled(relief);
    TileSums out(tiles.size(), VectorXd::Zero(size));
    parallel_for(tiles.size(), 1, [&](size_t t, int) {
        for (const uint32_t i : tiles[t]) add(relief.pixels[i], out[t]);
    });
    return out;
}

// Integrability.

/// With the gradients' Jacobian J, M' J is as far from symmetry as cos(angle) C + sin(angle) D, which is the curl in
/// the world's axes. Sums of CC, CD and DD for turns M, then for those that mirror first, over what bends are large.
TileSums curl_sums(const LitRelief& relief) {
    const auto slope = [&](int x, int y, Vec2d& out) {
        const ReliefPixel* p = relief.at(x, y);
        if (!p) return false;
        const Vec3d& b = p->facing;
        if (!(b.z() > 0.2 * b.norm())) return false;
        out = -b.head<2>() / b.z();
        return true;
    };
    const auto jacobian = [&](const ReliefPixel& p, Matrix2d& out) {
        Vec2d left, right, above, below;
        if (!slope(p.x - 1, p.y, left) || !slope(p.x + 1, p.y, right) || !slope(p.x, p.y - 1, above) ||
            !slope(p.x, p.y + 1, below))
            return false;
        out.col(0) = 0.5 * (right - left);
        out.col(1) = 0.5 * (above - below);
        return true;
    };
    std::vector<double> sizes;
    Matrix2d j;
    for (const ReliefPixel& p : relief.pixels)
        if (jacobian(p, j)) sizes.push_back(j.squaredNorm());
    const double typical = sizes.empty() ? 1 : std::max(median(std::move(sizes)), 1e-12);
    return sums(relief, 6, [&](const ReliefPixel& p, VectorXd& to) {
        Matrix2d of;
        if (!jacobian(p, of)) return;
        const double w = 1 / (of.squaredNorm() + typical);
        const double c = of(0, 1) - of(1, 0), d = of(0, 0) + of(1, 1);
        const double mirrored_c = of(0, 1) + of(1, 0), mirrored_d = of(1, 1) - of(0, 0);
        Eigen::Matrix<double, 6, 1> add;
        add << c * c, c * d, d * d, mirrored_c * mirrored_c, mirrored_c * mirrored_d, mirrored_d * mirrored_d;
        to += w * add;
    });
}

// Falloff.

constexpr int of_falloff = 4, of_reflection = 3, of_all = of_falloff + of_reflection;

/// Normal equations of what a matt surface under far lamps leaves over: by the falloff, x' A l (b . l) less what is
/// linear in l, and by an isotropic reflection of any axes, in powers of n . l, n_z and l_z.
TileSums falloff_sums(const LightStack& stack, const LitRelief& relief) {
    const size_t images = stack.images();
    // What is even over an image is its lamp's strength: each image's means are taken off.
    std::vector<Eigen::Vector<double, 5>> mean(images, Eigen::Vector<double, 5>::Zero());
    std::vector<double> whole(images, 1e-12);
    const auto factors = [&](const ReliefPixel& p, size_t i) {
        const Vec3d n = p.normal(), l = relief.directions[i];
        const double lit = n.dot(l);
        Eigen::Vector<double, 5> out;
        out << p.place.x(), p.place.y(), lit, lit * lit, l.z() * n.z();
        return out;
    };
    for (const ReliefPixel& p : relief.pixels)
        for (size_t i = 0; i < images; ++i) {
            if (!(p.weight[i] > 0)) continue;
            const double shown = relief.shown(p, i), w = double(p.weight[i]) * shown * shown;
            mean[i] += w * factors(p, i);
            whole[i] += w;
        }
    for (size_t i = 0; i < images; ++i) mean[i] /= whole[i];
    return sums(relief, of_all * of_all + of_all, [&](const ReliefPixel& p, VectorXd& to) {
        Eigen::Matrix<double, Eigen::Dynamic, 3> linear(Eigen::Index(images), 3);
        Eigen::Matrix<double, Eigen::Dynamic, of_all + 1> columns(Eigen::Index(images), of_all + 1);
        const Vec3d& b = p.facing;
        for (size_t i = 0; i < images; ++i) {
            const Eigen::Index row = Eigen::Index(i);
            const double root = std::sqrt(double(p.weight[i])), shown = relief.shown(p, i);
            const Vec3d& l = relief.directions[i];
            const auto f = Eigen::Vector<double, 5>(factors(p, i) - mean[i]);
            linear.row(row) = root * relief.strengths[i] * l.transpose();
            const double near = stack.closeness(i);
            columns.row(row) << root * near * (f[0] * l.x() * shown - relief.strengths[i] / 3 * p.place.x() * b.x()),
                root * near * (f[0] * l.y() * shown - relief.strengths[i] / 3 * p.place.x() * b.y()),
                root * near * (f[1] * l.x() * shown - relief.strengths[i] / 3 * p.place.y() * b.x()),
                root * near * (f[1] * l.y() * shown - relief.strengths[i] / 3 * p.place.y() * b.y()),
                root * f[2] * shown, root * f[3] * shown, root * f[4] * shown, root * (double(p.value[i]) - shown);
        }
        const Mat3d inner = linear.transpose() * linear + 1e-9 * Mat3d::Identity();
        const Eigen::Matrix<double, 3, of_all + 1> along = inner.ldlt().solve(linear.transpose() * columns);
        columns -= linear * along;
        const Eigen::Matrix<double, of_all + 1, of_all + 1> products = columns.transpose() * columns;
        for (int a = 0; a < of_all; ++a) {
            for (int c = 0; c < of_all; ++c) to[a * of_all + c] += products(a, c);
            to[of_all * of_all + a] += products(a, of_all);
        }
    });
}

/// [2][2] of file axes by world axes, as numbers, for a file as M is: in proportion to M.
Estimate falloff(const LightStack& stack, const LitRelief& relief) {
    return jackknife(falloff_sums(stack, relief), [](const VectorXd& sum) {
        MatrixXd matrix(of_all, of_all);
        for (int a = 0; a < of_all; ++a)
            for (int c = 0; c < of_all; ++c) matrix(a, c) = sum[a * of_all + c];
        matrix.diagonal().array() += 1e-9 * matrix.trace();
        const VectorXd all = solve_symmetric(matrix, VectorXd(sum.tail(of_all)));
        VectorXd out(4);  // A = 3 c M'
        out << all[0], all[2], all[1], all[3];
        return out;
    });
}

// Cast shadows.

/// As falloff(). Where it is darker than shown (a cast shadow), what lies towards the lamp turns away from it: from
/// there to beyond, n . l rises. Sums over pixels and images of darkness times that rise, by the lamps' x and y.
Estimate shadows(const LightStack& stack, const LitRelief& relief) {
    const size_t images = stack.images();
    constexpr double least_bend = 0.1;  // of normals: above it, edges count as much as soft bends
    // How dark against what would be shown: 1 where there is a shadow.
    const auto darkness = [&](const ReliefPixel& p, size_t i) {
        const double even = p.normal().dot(relief.directions[i]);
        if (!(even > 0.15) || !std::isfinite(stack.at(p.x, p.y)[i])) return -1.0;
        return std::clamp((0.7 - double(p.value[i]) / relief.shown(p, i)) / 0.4, 0.0, 1.0);
    };
    // What reflection alone makes dark depends on how the surface faces the lamp: its mean over all.
    constexpr int bins = 16;
    const auto bin_of = [&](const ReliefPixel& p, size_t i) {
        return size_t(std::clamp(int(bins * p.normal().dot(relief.directions[i])), 0, bins - 1));
    };
    std::vector<double> mean(bins, 0), count(bins, 1e-12);
    for (const ReliefPixel& p : relief.pixels)
        for (size_t i = 0; i < images; ++i) {
            const double dark = darkness(p, i);
            if (dark < 0) continue;
            mean[bin_of(p, i)] += dark;
            count[bin_of(p, i)] += 1;
        }
    for (size_t b = 0; b < bins; ++b) mean[b] /= count[b];
    Vec2d middle = Vec2d::Zero();
    for (const Vec3d& l : relief.directions) middle += l.head<2>() / double(images);
    Matrix2d spread = Matrix2d::Zero();
    for (const Vec3d& l : relief.directions)
        spread += (l.head<2>() - middle) * (l.head<2>() - middle).transpose() / double(images);
    const Matrix2d inverse = (spread + 1e-6 * Matrix2d::Identity()).inverse();
    const TileSums tiles = sums(relief, 4, [&](const ReliefPixel& p, VectorXd& to) {
        Matrix2d sum = Matrix2d::Zero();
        const ReliefPixel *left = relief.at(p.x - 1, p.y), *right = relief.at(p.x + 1, p.y);
        const ReliefPixel *above = relief.at(p.x, p.y - 1), *below = relief.at(p.x, p.y + 1);
        if (!left || !right || !above || !below) return;
        Vec3d across = right->normal() - left->normal(), up = above->normal() - below->normal();
        const double bend = std::sqrt(across.squaredNorm() + up.squaredNorm() + least_bend * least_bend);
        across /= bend;
        up /= bend;
        for (size_t i = 0; i < images; ++i) {
            const double dark = darkness(p, i);
            if (dark < 0) continue;
            const Vec3d& l = relief.directions[i];
            const Vec2d brighter(across.dot(l), up.dot(l));
            sum += (dark - mean[bin_of(p, i)]) * brighter * (l.head<2>() - middle).transpose();
        }
        const Matrix2d turned = -(sum * inverse).transpose();  // of file axes by world axes
        to += Vector4d(turned(0, 0), turned(0, 1), turned(1, 0), turned(1, 1));
    });
    return jackknife(tiles, [](const VectorXd& sum) { return sum; });
}

// Together.

/// By how much a turn misses an estimate that is in proportion to it, by a factor of 0 or more.
class MatrixCue {
public:
    explicit MatrixCue(const Estimate& estimate) : value_(estimate.value) {
        constexpr double model_error = 0.2;  // of the estimate
        MatrixXd covariance = estimate.covariance;
        const double least = 1e-6 * covariance.trace() + 1e-30;
        covariance.diagonal().array() += model_error * model_error * value_.squaredNorm() / 4 + least;
        inverse_ = covariance.inverse();
    }
    double miss(const Matrix2d& turn) const {
        const Vector4d m(turn(0, 0), turn(0, 1), turn(1, 0), turn(1, 1));
        const double along = std::max(0.0, m.dot(inverse_ * value_) / m.dot(inverse_ * m));
        const Vector4d off = value_ - along * m;
        return off.dot(inverse_ * off);
    }

private:
    Vector4d value_;
    Eigen::Matrix4d inverse_;
};

constexpr int steps = 360;  // of a degree, of either family
AxesTurn turn_at(int k) { return {k >= steps, double(k % steps)}; }

/// Integrability's miss of all turns: how much more curl they leave than the turn that leaves least.
std::vector<double> curl_misses(const LitRelief& relief) {
    constexpr double model_error = 0.1;  // of the mean over all turns
    using Sums = Eigen::Matrix<double, 6, 1>;
    const Estimate sums = jackknife(curl_sums(relief), [](const VectorXd& sum) {
        return VectorXd(sum / (0.25 * (sum[0] + sum[2] + sum[3] + sum[5]) + 1e-12));
    });
    const auto weights = [](int k) {
        const double angle = turn_at(k).degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
        Sums out = Sums::Zero();
        out.segment<3>(turn_at(k).mirrored ? 3 : 0) << c * c, 2 * c * s, s * s;
        return out;
    };
    Sums least = weights(0);
    for (int k = 1; k < 2 * steps; ++k)
        if (weights(k).dot(sums.value) < least.dot(sums.value)) least = weights(k);
    std::vector<double> out(2 * steps);
    for (int k = 0; k < 2 * steps; ++k) {
        const Sums more = weights(k) - least;
        const double curl = more.dot(sums.value), variance = more.dot(sums.covariance * more);
        out[size_t(k)] = curl * curl / (variance + model_error * model_error);
    }
    return out;
}

double angle_between(double a, double b) { return std::abs(std::remainder(a - b, 360.0)); }

}  // namespace

Matrix2d AxesTurn::matrix() const {
    Matrix2d out = Eigen::Rotation2Dd(degrees * std::numbers::pi / 180).toRotationMatrix();
    if (mirrored) out.col(1) *= -1;
    return out;
}

AxesFinding judge_axes(const LightStack& stack, const LitRelief& relief) {
    constexpr double near_enough = 15, apart = 45;  // degrees
    if (relief.pixels.size() < 100) return {};
    const std::vector<double> curl = curl_misses(relief);
    const MatrixCue by_falloff(falloff(stack, relief)), by_shadow(shadows(stack, relief));
    std::vector<double> misses(2 * steps);
    for (int k = 0; k < 2 * steps; ++k) {
        const Matrix2d turn = turn_at(k).matrix();
        misses[size_t(k)] = curl[size_t(k)] + by_falloff.miss(turn) + by_shadow.miss(turn);
    }
    const size_t least = size_t(std::ranges::min_element(misses) - misses.begin());
    AxesFinding out{turn_at(int(least)), std::numeric_limits<double>::infinity(),
                    std::numeric_limits<double>::infinity()};
    for (int k = 0; k < 2 * steps; ++k) {
        const AxesTurn turn = turn_at(k);
        const double more = misses[size_t(k)] - misses[least];
        if (!turn.mirrored && angle_between(turn.degrees, 0) <= near_enough) out.against = std::min(out.against, more);
        if (turn.mirrored != out.turn.mirrored || angle_between(turn.degrees, out.turn.degrees) > apart)
            out.runner_up = std::min(out.runner_up, more);
    }
    return out;
}

}  // namespace radiafit::tools
