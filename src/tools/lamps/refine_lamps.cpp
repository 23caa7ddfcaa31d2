#include "lamps/refine_lamps.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/decompositions.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "lamps/lamp_place.h"

namespace radiafit::tools {
namespace {

constexpr double shadow = 0.1;     // of a pixel's upper decile
constexpr double too_dark = 0.05;  // of the median pixel's
constexpr double cauchy = 2.385;   // robust deviations: 95 % as efficient as least squares under normal errors
constexpr size_t least_samples = 6, least_pixels = 30;
constexpr int first_rounds = 10, most_rounds = 40;

/// A pixel's samples, scaled so that its upper decile is 1.
struct LitPixel {
    Vec3d position = Vec3d::Zero();
    uint32_t patch = 0;
    std::vector<uint32_t> lamp = {};
    std::vector<double> value = {}, weight = {};
    Vec3d facing = Vec3d::Zero();  ///< normal times colour
};

/// Channel 3: the mean of the three.
std::vector<LitPixel> lit_pixels(const SurfaceSamples& samples, size_t channel) {
    std::vector<LitPixel> pixels;
    std::vector<double> deciles;
    for (size_t p = 0; p < samples.pixels(); ++p) {
        LitPixel pixel{.position = samples.positions[p], .patch = samples.patches[p]};
        for (size_t i = 0; i < samples.images; ++i) {
            const float* rgb = samples.at(p, i);
            const double value =
                channel < 3 ? double(rgb[channel]) : (double(rgb[0]) + double(rgb[1]) + double(rgb[2])) / 3;
            if (!std::isfinite(value)) continue;
            pixel.lamp.push_back(uint32_t(i));
            pixel.value.push_back(value);
        }
        if (pixel.lamp.size() < least_samples) continue;
        const double decile = quantile(pixel.value, 0.9);
        if (!(decile > 0)) continue;
        for (double& v : pixel.value) v /= decile;
        pixel.weight.assign(pixel.value.size(), 1.0);
        pixels.push_back(std::move(pixel));
        deciles.push_back(decile);
    }
    if (pixels.empty()) return pixels;
    const double least = too_dark * median(deciles);
    std::vector<LitPixel> bright;
    for (size_t i = 0; i < pixels.size(); ++i)
        if (deciles[i] >= least) bright.push_back(std::move(pixels[i]));
    return bright;
}

/// Unknowns of a lamp: the logarithm of its strength, then LampPlace::moved()'s step if places are asked for.
class LampSolver {
public:
    /// prior: inverse covariance of all lamps' steps; empty: places are held.
    LampSolver(std::vector<LitPixel> pixels, const std::vector<CalibratedLamp>& lamps, Eigen::MatrixXd prior)
        : pixels_(std::move(pixels)),
          of_lamp_(prior.size() > 0 ? 4 : 1),
          size_(of_lamp_ * Eigen::Index(lamps.size())),
          logarithm_(Eigen::VectorXd::Zero(Eigen::Index(lamps.size()))),
          prior_(std::move(prior)) {
        for (const CalibratedLamp& lamp : lamps) said_.push_back(LampPlace::of(lamp.light));
        places_ = said_;
        prepare();
    }

    void solve() {
        for (int round = 0; round < most_rounds; ++round) {
            face_pixels();
            weigh(round == 0);
            face_pixels();
            Eigen::VectorXd step = Eigen::VectorXd::Zero(size_);
            if (round < first_rounds) {
                const Eigen::VectorXd brighter = alternating_step();
                for (Eigen::Index i = 0; i < brighter.size(); ++i) step[i * of_lamp_] = brighter[i];
            } else {
                step = solve_symmetric(matrix(), gradient());
            }
            take(step);
            if (round > first_rounds && step.cwiseAbs().maxCoeff() < 1e-7) break;
        }
        face_pixels();
    }
    double strength(size_t lamp) const { return strengths_[lamp]; }
    const LampPlace& place(size_t lamp) const { return places_[lamp]; }

    /// Of all unknowns.
    Eigen::MatrixXd covariance() const {
        std::map<uint32_t, Eigen::VectorXd> of_patches;
        for (const LitPixel& p : pixels_) {
            auto [patch, is_new] = of_patches.try_emplace(p.patch, Eigen::VectorXd::Zero(size_));
            add_gradient(p, patch->second);
        }
        const double count = double(of_patches.size());
        Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(size_, size_);
        for (const auto& [patch, gradient] : of_patches)
            middle += count / std::max(count - 1, 1.0) * gradient * gradient.transpose();
        add_prior(middle);
        const Eigen::MatrixXd curvature = matrix(), half = solve_symmetric(curvature, middle);
        return solve_symmetric(curvature, Eigen::MatrixXd(half.transpose()));
    }

private:
    /// What lights a surface that faces it, times the direction to the lamp, where the origin has 1.
    static Vec3d lit_from(const LampPlace& place, const Vec3d& x) {
        if (place.closeness <= 0) return place.direction;
        const Vec3d to = place.direction - place.closeness * x;  // over the lamp's distance
        return to / (to.squaredNorm() * to.norm());
    }
    Vec3d slope(const LitPixel& p, size_t k) const {
        return strength(p.lamp[k]) * lit_from(places_[p.lamp[k]], p.position);
    }
    double residual(const LitPixel& p, size_t k) const { return p.value[k] - slope(p, k).dot(p.facing); }

    /// Derivatives of the shown value by the lamp's unknowns.
    Eigen::Vector4d by_lamp(const LitPixel& p, size_t k) const {
        Eigen::Vector4d out = Eigen::Vector4d::Zero();
        out[0] = slope(p, k).dot(p.facing);
        if (of_lamp_ == 1) return out;
        const Vec3d before = lit_from(places_[p.lamp[k]], p.position);
        for (int n = 0; n < 3; ++n) {
            const Nearby& nearby = nearby_[3 * p.lamp[k] + size_t(n)];
            if (nearby.step > 0)
                out[1 + n] =
                    strength(p.lamp[k]) * (lit_from(nearby.place, p.position) - before).dot(p.facing) / nearby.step;
        }
        return out;
    }
    /// What pixels ask of each lamp, after it was moved.
    void prepare() {
        strengths_.assign(places_.size(), 0);
        for (size_t i = 0; i < places_.size(); ++i) strengths_[i] = std::exp(logarithm_[Eigen::Index(i)]);
        if (of_lamp_ == 1) return;
        nearby_.clear();
        for (const LampPlace& place : places_)
            for (int n = 0; n < 3; ++n) {
                const double step = n == 2 ? 1e-6 * place.closeness : 1e-6;
                nearby_.push_back({place.moved(step * Vec3d::Unit(n)), step});
            }
    }
    void face_pixels() {
        parallel_for(pixels_.size(), 64, [&](size_t i, int) {
            LitPixel& p = pixels_[i];
            Mat3d matrix = Mat3d::Identity() * 1e-9;
            Vec3d right = Vec3d::Zero();
            for (size_t k = 0; k < p.lamp.size(); ++k) {
                const Vec3d s = slope(p, k);
                matrix += p.weight[k] * s * s.transpose();
                right += p.weight[k] * p.value[k] * s;
            }
            p.facing = solve_symmetric(matrix, right);
        });
    }
    /// Weights: Cauchy's, over the residuals' variance; 0 in shadow, at first by the values, then by what would be
    /// shown.
    void weigh(bool by_values) {
        std::vector<double> off;
        for (const LitPixel& p : pixels_)
            for (size_t k = 0; k < p.lamp.size(); ++k)
                if (p.weight[k] > 0) off.push_back(std::abs(residual(p, k)));
        const double deviation = std::max(1.4826 * median(std::move(off)), 1e-6);
        parallel_for(pixels_.size(), 64, [&](size_t i, int) {
            LitPixel& p = pixels_[i];
            std::vector<double> even;  // under lamps of one strength
            for (size_t k = 0; k < p.lamp.size(); ++k)
                even.push_back(by_values ? p.value[k] / strength(p.lamp[k])
                                         : lit_from(places_[p.lamp[k]], p.position).dot(p.facing));
            const double dark = shadow * quantile(even, 0.9);
            for (size_t k = 0; k < p.lamp.size(); ++k) {
                const double r = residual(p, k) / (cauchy * deviation);
                p.weight[k] = even[k] > 0 && even[k] >= dark ? 1 / (deviation * deviation * (1 + r * r)) : 0;
            }
        });
    }
    Eigen::VectorXd alternating_step() const {
        Eigen::VectorXd over = Eigen::VectorXd::Constant(logarithm_.size(), 1e-12), under = over;
        for (const LitPixel& p : pixels_)
            for (size_t k = 0; k < p.lamp.size(); ++k) {
                const double shown = slope(p, k).dot(p.facing);
                over[p.lamp[k]] += p.weight[k] * shown * p.value[k];
                under[p.lamp[k]] += p.weight[k] * shown * shown;
            }
        return (over.array() / under.array()).max(0.1).log();
    }
    void take(const Eigen::VectorXd& step) {
        for (size_t i = 0; i < places_.size(); ++i) {
            const Eigen::Index at = Eigen::Index(i) * of_lamp_;
            logarithm_[Eigen::Index(i)] += std::clamp(step[at], -0.5, 0.5);
            if (of_lamp_ == 4) {
                Vec3d move = step.segment<3>(at + 1).cwiseMax(-0.1).cwiseMin(0.1);
                move.z() = std::clamp(step[at + 3], -0.2 * places_[i].closeness, 0.2 * places_[i].closeness);
                places_[i] = places_[i].moved(move);
            }
        }
        logarithm_.array() -= logarithm_.mean();
        prepare();
    }
    void add_prior(Eigen::MatrixXd& to) const {
        if (of_lamp_ == 1) return;
        for (Eigen::Index a = 0; a < logarithm_.size(); ++a)
            for (Eigen::Index b = 0; b < logarithm_.size(); ++b)
                to.block<3, 3>(4 * a + 1, 4 * b + 1) += prior_.block<3, 3>(3 * a, 3 * b);
    }
    /// How far a lamp is off where it was said to be, as a step from there.
    Vec3d off(size_t i) const {
        const Vec3d change = places_[i].direction - said_[i].direction;
        const auto across = said_[i].across();
        return {across.col(0).dot(change), across.col(1).dot(change), places_[i].closeness - said_[i].closeness};
    }
    void add_gradient(const LitPixel& p, Eigen::VectorXd& to) const {
        for (size_t k = 0; k < p.lamp.size(); ++k)
            if (p.weight[k] > 0)
                to.segment(of_lamp_ * Eigen::Index(p.lamp[k]), of_lamp_) +=
                    p.weight[k] * residual(p, k) * by_lamp(p, k).head(of_lamp_);
    }
    Eigen::VectorXd gradient() const {
        Eigen::VectorXd out = Eigen::VectorXd::Zero(size_);
        for (const LitPixel& p : pixels_) add_gradient(p, out);
        if (of_lamp_ == 1) return out;
        Eigen::VectorXd all(3 * logarithm_.size());
        for (size_t i = 0; i < places_.size(); ++i) all.segment<3>(3 * Eigen::Index(i)) = off(i);
        const Eigen::VectorXd pull = prior_ * all;
        for (Eigen::Index i = 0; i < logarithm_.size(); ++i) out.segment<3>(4 * i + 1) -= pull.segment<3>(3 * i);
        return out;
    }
    /// To the lower triangle.
    void add_reduced(const LitPixel& p, Eigen::MatrixXd& to) const {
        Eigen::Matrix<double, Eigen::Dynamic, 3> mixed = Eigen::Matrix<double, Eigen::Dynamic, 3>::Zero(size_, 3);
        Mat3d own = Mat3d::Identity() * 1e-9;
        for (size_t k = 0; k < p.lamp.size(); ++k) {
            if (!(p.weight[k] > 0)) continue;
            const Vec3d s = slope(p, k);
            const Eigen::Vector4d all = by_lamp(p, k);
            const auto d = all.head(of_lamp_);
            const Eigen::Index at = of_lamp_ * Eigen::Index(p.lamp[k]);
            own += p.weight[k] * s * s.transpose();
            mixed.middleRows(at, of_lamp_) = p.weight[k] * d * s.transpose();
            to.block(at, at, of_lamp_, of_lamp_) += p.weight[k] * d * d.transpose();
        }
        const Eigen::Matrix<double, Eigen::Dynamic, 3> through = mixed * own.inverse();
        for (Eigen::Index j = 0; j < size_; ++j)
            to.col(j).tail(size_ - j).noalias() -= through.bottomRows(size_ - j).lazyProduct(mixed.row(j).transpose());
    }
    /// The pixels' unknowns eliminated; what all lamps' strengths share is held.
    Eigen::MatrixXd matrix() const {
        constexpr size_t parts = 16;  // always the same, so that sums are
        std::vector<Eigen::MatrixXd> sums(parts, Eigen::MatrixXd::Zero(size_, size_));
        parallel_for(parts, 1, [&](size_t part, int) {
            for (size_t i = part; i < pixels_.size(); i += parts) add_reduced(pixels_[i], sums[part]);
        });
        Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size_, size_);
        for (const Eigen::MatrixXd& m : sums) sum += m;
        sum.triangularView<Eigen::StrictlyUpper>() = sum.transpose();
        const Eigen::Index lamps = logarithm_.size();
        double hold = 0;
        for (Eigen::Index i = 0; i < lamps; ++i) hold += sum(i * of_lamp_, i * of_lamp_) / double(lamps);
        for (Eigen::Index a = 0; a < lamps; ++a)
            for (Eigen::Index b = 0; b < lamps; ++b) sum(a * of_lamp_, b * of_lamp_) += hold / double(lamps);
        add_prior(sum);
        return sum;
    }

    std::vector<LitPixel> pixels_;
    Eigen::Index of_lamp_, size_;
    Eigen::VectorXd logarithm_;  ///< of the strengths
    std::vector<LampPlace> said_, places_;
    struct Nearby {
        LampPlace place;
        double step;
    };
    std::vector<Nearby> nearby_;     ///< [lamps][3] a step off in each number of moved()
    std::vector<double> strengths_;  ///< [lamps]
    Eigen::MatrixXd prior_;
};

std::vector<LitPixel> enough(std::vector<LitPixel> pixels) {
    if (pixels.size() < least_pixels)
        throw UserError("the surface is too dark, masked or clipped to tell of its lamps");
    return pixels;
}

/// The inverse where the covariance isn't 0; what has none is held.
Eigen::MatrixXd inverse_of_held(const Eigen::MatrixXd& covariance) {
    Eigen::MatrixXd filled = covariance;
    for (Eigen::Index i = 0; i < filled.rows(); ++i)
        if (!(filled(i, i) > 0)) filled(i, i) = 1e-24;
    // Numbers of unlike sizes: to those of unit deviation first.
    const Eigen::VectorXd scale = filled.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd even = scale.asDiagonal() * filled * scale.asDiagonal();
    const Eigen::MatrixXd inverse =
        inverse_of_symmetric(even + 1e-9 * Eigen::MatrixXd::Identity(even.rows(), even.cols()));
    return scale.asDiagonal() * inverse * scale.asDiagonal();
}

}  // namespace

RefinedLamps refine_lamps(const std::vector<CalibratedLamp>& lamps, const Eigen::MatrixXd& covariance,
                          const SurfaceSamples& samples) {
    RefinedLamps out{lamps, std::vector<Vec3d>(lamps.size()), std::vector<Vec3d>(lamps.size())};
    if (covariance.size() > 0) {
        LampSolver solver(enough(lit_pixels(samples, 3)), lamps, inverse_of_held(covariance));
        solver.solve();
        const Eigen::MatrixXd after = solver.covariance();
        for (size_t i = 0; i < lamps.size(); ++i) {
            const Mat3d by_step = solver.place(i).place_by_step();
            const Eigen::Index at = 4 * Eigen::Index(i) + 1;
            out.lamps[i].light = solver.place(i).light();
            out.lamps[i].covariance = by_step * after.block<3, 3>(at, at) * by_step.transpose();
        }
    }
    for (size_t c = 0; c < 3; ++c) {
        LampSolver solver(enough(lit_pixels(samples, c)), out.lamps, {});
        solver.solve();
        const Eigen::MatrixXd after = solver.covariance();
        for (size_t i = 0; i < lamps.size(); ++i) {
            out.strengths[i][Eigen::Index(c)] = solver.strength(i);
            out.deviations[i][Eigen::Index(c)] = std::sqrt(std::max(after(Eigen::Index(i), Eigen::Index(i)), 0.0));
        }
    }
    return out;
}

Vec3d intensity_of(const Light& lamp, const Vec3d& strength) {
    return lamp.kind == Light::Kind::near ? Vec3d(lamp.place.squaredNorm() * strength) : strength;
}

}  // namespace radiafit::tools
