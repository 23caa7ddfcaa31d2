#include "lamps/sphere_lamps.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "base/decompositions.h"
#include "base/statistics.h"
#include "lamps/lamp_place.h"
#include "lamps/least_squares.h"

namespace radiafit::tools {
namespace {

constexpr double least_outline_deviation = 0.1;  // pixels: what an outline's form leaves open
constexpr double known_distance = 0.1;           // share of it, from which on a lamp's place is told
constexpr double outlier = 6;                    // median residuals

/// The surface point of a sphere that the picture shows at a place, or the nearest one of its outline.
Vec3d seen_point(const Vec2d& place, const GlossySphere& sphere, const PictureFrame& frame) {
    const Vec3d on_plane = frame.plane_point(place), up = frame.direction_to_camera(on_plane);
    const Vec3d from = on_plane - sphere.centre;
    const double along = from.dot(up), rest = along * along - from.squaredNorm() + sphere.radius * sphere.radius;
    if (rest >= 0) return on_plane + (-along + std::sqrt(rest)) * up;
    return sphere.centre + sphere.radius * (from - along * up).normalized();
}

struct Ray {
    Vec3d from, direction;
};
Ray to_lamp(const Vec2d& highlight, const GlossySphere& sphere, const PictureFrame& frame) {
    const Vec3d point = seen_point(highlight, sphere, frame), n = (point - sphere.centre).normalized();
    const Vec3d v = frame.direction_to_camera(point);
    return {point, (2 * n.dot(v) * n - v).normalized()};
}

/// Where rays to a lamp come nearest to each other; far away where they don't meet ahead.
LampPlace nearest(const std::vector<Ray>& to, bool near) {
    Vec3d mean = Vec3d::Zero(), origin = Vec3d::Zero();
    Mat3d matrix = Mat3d::Zero();
    Vec3d right = Vec3d::Zero();
    for (const Ray& ray : to) {
        const Mat3d across = Mat3d::Identity() - ray.direction * ray.direction.transpose();
        mean += ray.direction;
        origin += ray.from / double(to.size());
        matrix += across;
        right += across * ray.from;
    }
    mean.normalize();
    if (!near) return {mean, 0};
    double spread = 0;
    for (const Ray& ray : to) spread = std::max(spread, (ray.from - origin).norm());
    Vec3d x = origin + 10 * spread * mean;
    if (const Vec3d met = solve_symmetric(matrix, right); met.allFinite() && (met - origin).dot(mean) > spread) x = met;
    return {x.normalized(), 1 / x.norm()};
}

/// All lamps and outlines: least squares of highlights and outlines off where they were found.
class Adjustment {
public:
    struct Sight {
        size_t lamp, sphere;
        Highlight seen;
    };
    Adjustment(std::vector<Circle> found, std::vector<Sight> sights, size_t lamps, const PictureFrame& frame, bool near)
        : found_(std::move(found)), sights_(std::move(sights)), frame_(&frame), numbers_(near ? 3 : 2) {
        for (Circle& c : found_) c.deviation = std::hypot(c.deviation, least_outline_deviation);
        state_.outlines = found_;
        const std::vector<GlossySphere> spheres = spheres_of(found_);
        std::vector<std::vector<Ray>> to(lamps);
        for (const Sight& s : sights_) to[s.lamp].push_back(to_lamp(s.seen.place, spheres[s.sphere], frame));
        for (const auto& rays : to) state_.places.push_back(nearest(rays, near));
    }

    struct State {
        std::vector<LampPlace> places;
        std::vector<Circle> outlines;
    };

    void solve() {
        const auto residuals = [&](const State& state) { return residuals_of(state); };
        const auto jacobian = [&](const State& state, const Eigen::VectorXd& now) { return jacobian_of(state, now); };
        const auto moved = [&](const State& state, const Eigen::VectorXd& step) { return stepped(state, step); };
        const Eigen::VectorXd left = minimize(state_, residuals, jacobian, moved);
        const double freedom = double(2 * sights_.size()) - double(state_.places.size() * size_t(numbers_));
        const double scale = freedom > 0 ? std::max(1.0, left.squaredNorm() / freedom) : 1.0;
        const Eigen::MatrixXd slope = jacobian_of(state_, left), matrix = slope.transpose() * slope;
        covariance_ = scale * inverse_of_symmetric(matrix);
    }
    const std::vector<Circle>& outlines() const { return state_.outlines; }
    std::vector<CalibratedLamp> lamps() const {
        std::vector<CalibratedLamp> out;
        for (size_t i = 0; i < state_.places.size(); ++i) {
            const LampPlace& place = state_.places[i];
            const Eigen::Index at = Eigen::Index(i) * numbers_;
            const Eigen::MatrixXd by_step = place.place_by_step().leftCols(numbers_);
            out.push_back({.light = place.light()});
            out.back().covariance = by_step * covariance_.block(at, at, numbers_, numbers_) * by_step.transpose();
        }
        const std::vector<GlossySphere> spheres = spheres_of(state_.outlines);
        for (const Sight& s : sights_) {
            CalibratedLamp& lamp = out[s.lamp];
            lamp.residual += (highlight_of(lamp.light, spheres[s.sphere], *frame_) - s.seen.place).squaredNorm();
            ++lamp.spheres;
        }
        for (CalibratedLamp& lamp : out) lamp.residual = std::sqrt(lamp.residual / double(lamp.spheres));
        return out;
    }
    /// Of all lamps' steps, three by three.
    Eigen::MatrixXd steps_covariance() const {
        const auto count = Eigen::Index(state_.places.size());
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * count, 3 * count);
        for (Eigen::Index a = 0; a < count; ++a)
            for (Eigen::Index b = 0; b < count; ++b)
                out.block(3 * a, 3 * b, numbers_, numbers_) =
                    covariance_.block(a * numbers_, b * numbers_, numbers_, numbers_);
        return out;
    }

private:
    std::vector<GlossySphere> spheres_of(const std::vector<Circle>& outlines) const {
        std::vector<GlossySphere> out;
        for (const Circle& outline : outlines) out.push_back(sphere_of(outline, *frame_));
        return out;
    }
    /// Of a highlight, and of an outline, in standard deviations.
    Vec2d off(const Sight& s, const LampPlace& place, const GlossySphere& sphere) const {
        return (highlight_of(place.light(), sphere, *frame_) - s.seen.place) / s.seen.deviation;
    }
    Vec3d off(size_t outline, const Circle& now) const {
        const Circle& then = found_[outline];
        const Vec2d centre = now.centre - then.centre;
        return Vec3d(centre.x(), centre.y(), now.radius - then.radius) / then.deviation;
    }
    Eigen::VectorXd residuals_of(const State& state) const {
        const std::vector<GlossySphere> spheres = spheres_of(state.outlines);
        Eigen::VectorXd out(Eigen::Index(2 * sights_.size() + 3 * found_.size()));
        for (size_t i = 0; i < sights_.size(); ++i)
            out.segment<2>(Eigen::Index(2 * i)) =
                off(sights_[i], state.places[sights_[i].lamp], spheres[sights_[i].sphere]);
        for (size_t k = 0; k < found_.size(); ++k)
            out.segment<3>(Eigen::Index(2 * sights_.size() + 3 * k)) = off(k, state.outlines[k]);
        return out;
    }
    /// By differences: a highlight depends on its lamp and its sphere alone.
    Eigen::MatrixXd jacobian_of(const State& state, const Eigen::VectorXd& now) const {
        constexpr double turn = 1e-5, pixels = 1e-4;
        const std::vector<GlossySphere> spheres = spheres_of(state.outlines);
        std::vector<GlossySphere> changed;  // [outline][x, y, radius]
        for (const Circle& outline : state.outlines)
            for (int k = 0; k < 3; ++k) changed.push_back(sphere_of(moved(outline, pixels * Vec3d::Unit(k)), *frame_));
        const Eigen::Index lamps = Eigen::Index(state.places.size()) * numbers_;
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(now.size(), lamps + 3 * Eigen::Index(found_.size()));
        for (size_t i = 0; i < sights_.size(); ++i) {
            const Eigen::Index row = Eigen::Index(2 * i);
            const Sight& s = sights_[i];
            const LampPlace& place = state.places[s.lamp];
            const double closer = 1e-5 * place.closeness + 1e-9 / (frame_->pixel * frame_->width);
            for (int k = 0; k < numbers_; ++k) {
                const double step = k == 2 ? closer : turn;
                out.block<2, 1>(row, Eigen::Index(s.lamp) * numbers_ + k) =
                    (off(s, place.moved(step * Vec3d::Unit(k)), spheres[s.sphere]) - now.segment<2>(row)) / step;
            }
            for (int k = 0; k < 3; ++k)
                out.block<2, 1>(row, lamps + 3 * Eigen::Index(s.sphere) + k) =
                    (off(s, place, changed[3 * s.sphere + size_t(k)]) - now.segment<2>(row)) / pixels;
        }
        for (size_t k = 0; k < found_.size(); ++k)
            out.block<3, 3>(Eigen::Index(2 * sights_.size() + 3 * k), lamps + 3 * Eigen::Index(k)) =
                Mat3d::Identity() / found_[k].deviation;
        return out;
    }
    static Circle moved(Circle circle, const Vec3d& by) {
        circle.centre += by.head<2>();
        circle.radius += by.z();
        return circle;
    }
    State stepped(const State& from, const Eigen::VectorXd& change) const {
        State out;
        for (const LampPlace& place : from.places) {
            Vec3d step = Vec3d::Zero();
            step.head(numbers_) = change.segment(Eigen::Index(out.places.size()) * numbers_, numbers_);
            out.places.push_back(place.moved(step));
        }
        const Eigen::Index lamps = Eigen::Index(from.places.size()) * numbers_;
        for (const Circle& outline : from.outlines)
            out.outlines.push_back(moved(outline, change.segment<3>(lamps + 3 * Eigen::Index(out.outlines.size()))));
        return out;
    }

    std::vector<Circle> found_;
    std::vector<Sight> sights_;
    const PictureFrame* frame_;
    int numbers_;  ///< of a lamp: 2 of its direction, and its closeness
    State state_;
    Eigen::MatrixXd covariance_;  ///< of the lamps' steps, then of the outlines' x, y and radius
};

}  // namespace

Vec2d PictureFrame::project(const Vec3d& x) const {
    const Vec3d up = direction_to_camera(x);
    return place_of(x - x.z() / up.z() * up);
}

GlossySphere sphere_of(const Circle& outline, const PictureFrame& frame) {
    const Vec3d middle = frame.plane_point(outline.centre);
    GlossySphere sphere{{middle.x(), middle.y(), outline.radius * frame.pixel}, outline.radius * frame.pixel};
    if (!frame.eye) return sphere;
    // The cone of sight that touches the sphere meets the plane in an outline, whose middle and mean radius are given.
    for (int step = 0; step < 30; ++step) {
        const Vec3d axis = sphere.centre - *frame.eye;
        const double distance = axis.norm(), sine = std::min(sphere.radius / distance, 0.99);
        const Vec3d along = axis / distance, other = std::abs(along.x()) < 0.9 ? Vec3d::UnitX() : Vec3d::UnitY();
        const Vec3d right = along.cross(other).normalized(), up = along.cross(right);
        constexpr int points = 64;
        std::vector<Vec2d> outlined;
        Vec2d centre = Vec2d::Zero();
        for (int i = 0; i < points; ++i) {
            const double angle = 2 * std::numbers::pi * i / points;
            const Vec3d ray =
                std::sqrt(1 - sine * sine) * along + sine * (std::cos(angle) * right + std::sin(angle) * up);
            const Vec3d met = *frame.eye - frame.eye->z() / ray.z() * ray;
            outlined.emplace_back(met.x(), met.y());
            centre += outlined.back() / points;
        }
        double radius = 0;
        for (const Vec2d& p : outlined) radius += (p - centre).norm() / points;
        const Vec2d off = middle.head<2>() - centre;
        const double factor = outline.radius * frame.pixel / radius;
        sphere.centre.head<2>() += off;
        sphere.radius *= factor;
        sphere.centre.z() = sphere.radius;
        if (off.norm() < 1e-12 * sphere.radius && std::abs(factor - 1) < 1e-12) break;
    }
    return sphere;
}

Vec2d highlight_of(const Light& lamp, const GlossySphere& sphere, const PictureFrame& frame) {
    Vec3d n = (frame.direction_to_camera(sphere.centre) + lamp.direction_from(sphere.centre)).normalized();
    for (int step = 0; step < 100; ++step) {
        const Vec3d point = sphere.centre + sphere.radius * n;
        const Vec3d half = (frame.direction_to_camera(point) + lamp.direction_from(point)).normalized();
        const double off = (half - n).norm();
        n = half;
        if (off < 1e-13) break;
    }
    return frame.project(sphere.centre + sphere.radius * n);
}

double CalibratedLamp::deviation_degrees() const {
    const double length = light.place.norm();
    const Vec3d direction = light.place / length;
    const Mat3d across = Mat3d::Identity() - direction * direction.transpose();
    const Vec3d variances = symmetric_eigenvalues(Mat3d(across * covariance * across));
    return std::sqrt(std::max(variances[2], 0.0)) / length * 180 / std::numbers::pi;
}

double CalibratedLamp::deviation_of_distance() const {
    const double length = light.place.norm();
    const Vec3d direction = light.place / length;
    return std::sqrt(std::max(direction.dot(covariance * direction), 0.0)) / length;
}

SphereLamps lamps_by_spheres(const std::vector<Circle>& outlines,
                             const std::vector<std::vector<std::optional<Highlight>>>& highlights,
                             const PictureFrame& frame) {
    if (outlines.empty()) throw std::invalid_argument("lamps_by_spheres: no sphere");
    std::vector<bool> left_out(highlights.size(), false);
    const auto adjusted = [&](bool near) {
        std::vector<uint32_t> images;
        std::vector<Adjustment::Sight> sights;
        for (size_t i = 0; i < highlights.size(); ++i) {
            const auto count =
                size_t(std::ranges::count_if(highlights[i], [](const auto& h) { return h.has_value(); }));
            if (left_out[i] || count < (near ? 2 : 1)) continue;
            for (size_t s = 0; s < outlines.size(); ++s)
                if (highlights[i][s]) sights.push_back({images.size(), s, *highlights[i][s]});
            images.push_back(uint32_t(i));
        }
        Adjustment a(outlines, std::move(sights), images.size(), frame, near);
        if (images.empty()) return SphereLamps{.images = {}, .lamps = {}, .covariance = {}, .outlines = outlines};
        a.solve();
        return SphereLamps{.images = std::move(images),
                           .lamps = a.lamps(),
                           .covariance = a.steps_covariance(),
                           .outlines = a.outlines(),
                           .near = near};
    };
    const auto without_outliers = [&](bool near) {
        SphereLamps out = adjusted(near);
        std::vector<double> residuals;
        for (const CalibratedLamp& lamp : out.lamps)
            if (lamp.spheres > 1) residuals.push_back(lamp.residual);
        const double most = std::max(residuals.empty() ? 0.0 : outlier * median(residuals), 0.5);
        bool any = false;
        for (size_t k = 0; k < out.lamps.size(); ++k)
            if (out.lamps[k].residual > most) left_out[out.images[k]] = any = true;
        return any ? adjusted(near) : out;
    };
    if (outlines.size() > 1) {
        SphereLamps near = without_outliers(true);
        std::vector<double> deviations;
        for (const CalibratedLamp& lamp : near.lamps)
            deviations.push_back(lamp.light.kind == Light::Kind::near ? lamp.deviation_of_distance() : 1);
        if (!deviations.empty() && median(deviations) <= known_distance) return near;
        std::fill(left_out.begin(), left_out.end(), false);
    }
    return without_outliers(false);
}

}  // namespace radiafit::tools
