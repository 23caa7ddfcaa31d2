#include "lamps/sphere_lamps.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "base/statistics.h"
#include "lamps/lamp_place.h"

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
    if (const Vec3d met = matrix.ldlt().solve(right); met.allFinite() && (met - origin).dot(mean) > spread) x = met;
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
        outlines = found_;
        std::vector<std::vector<Ray>> to(lamps);
        for (const Sight& s : sights_)
            to[s.lamp].push_back(to_lamp(s.seen.place, sphere_of(found_[s.sphere], frame), frame));
        for (const auto& rays : to) places.push_back(nearest(rays, near));
    }

    std::vector<LampPlace> places;
    std::vector<Circle> outlines;
    Eigen::MatrixXd covariance;  ///< of the lamps' steps, then of the outlines' x, y and radius

    void solve() {
        Eigen::VectorXd residuals = residuals_of(places, outlines);
        double damping = 1e-6;
        for (int step = 0; step < 100; ++step) {
            const Eigen::MatrixXd jacobian = jacobian_of(residuals);
            const Eigen::MatrixXd matrix = jacobian.transpose() * jacobian;
            const Eigen::VectorXd gradient = jacobian.transpose() * residuals;
            bool better = false;
            for (int attempt = 0; attempt < 20 && !better; ++attempt) {
                Eigen::MatrixXd damped = matrix;
                damped.diagonal() *= 1 + damping;
                const Eigen::VectorXd change = -damped.ldlt().solve(gradient);
                auto [moved, changed] = stepped(change);
                const Eigen::VectorXd after = residuals_of(moved, changed);
                better = after.squaredNorm() < residuals.squaredNorm();
                damping = better ? damping / 10 : damping * 10;
                if (!better) continue;
                const double gain = residuals.squaredNorm() - after.squaredNorm();
                places = std::move(moved);
                outlines = std::move(changed);
                residuals = after;
                if (gain < 1e-12 * (1 + after.squaredNorm())) step = 100;
            }
            if (!better) break;
        }
        const Eigen::MatrixXd jacobian = jacobian_of(residuals);
        const double freedom = double(2 * sights_.size()) - double(places.size() * size_t(numbers_));
        const double scale = freedom > 0 ? std::max(1.0, residuals.squaredNorm() / freedom) : 1.0;
        const Eigen::Index size = jacobian.cols();
        covariance =
            scale *
            Eigen::MatrixXd(jacobian.transpose() * jacobian).ldlt().solve(Eigen::MatrixXd::Identity(size, size));
    }
    /// Root mean square distance of a lamp's highlights from where they should be, pixels.
    std::vector<double> distances() const {
        std::vector<double> squares(places.size(), 0), count(places.size(), 0);
        for (const Sight& s : sights_) {
            squares[s.lamp] += (expected(s, places, outlines) - s.seen.place).squaredNorm();
            ++count[s.lamp];
        }
        for (size_t i = 0; i < squares.size(); ++i) squares[i] = std::sqrt(squares[i] / std::max(count[i], 1.0));
        return squares;
    }
    CalibratedLamp lamp(size_t i) const {
        const LampPlace& place = places[i];
        const Eigen::Index at = Eigen::Index(i) * numbers_;
        const Eigen::MatrixXd by_step = place.place_by_step().leftCols(numbers_);
        CalibratedLamp out{.light = place.light()};
        out.covariance = by_step * covariance.block(at, at, numbers_, numbers_) * by_step.transpose();
        for (const Sight& s : sights_) out.spheres += s.lamp == i;
        out.residual = distances()[i];
        return out;
    }
    /// Of all lamps' steps, three by three.
    Eigen::MatrixXd steps_covariance() const {
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * Eigen::Index(places.size()), 3 * Eigen::Index(places.size()));
        for (Eigen::Index a = 0; a < Eigen::Index(places.size()); ++a)
            for (Eigen::Index b = 0; b < Eigen::Index(places.size()); ++b)
                out.block(3 * a, 3 * b, numbers_, numbers_) =
                    covariance.block(a * numbers_, b * numbers_, numbers_, numbers_);
        return out;
    }

private:
    Vec2d expected(const Sight& s, const std::vector<LampPlace>& at, const std::vector<Circle>& with) const {
        return highlight_of(at[s.lamp].light(), sphere_of(with[s.sphere], *frame_), *frame_);
    }
    Eigen::VectorXd residuals_of(const std::vector<LampPlace>& at, const std::vector<Circle>& with) const {
        Eigen::VectorXd out(Eigen::Index(2 * sights_.size() + 3 * with.size()));
        for (size_t i = 0; i < sights_.size(); ++i) out.segment<2>(Eigen::Index(2 * i)) = residual(i, at, with);
        for (size_t k = 0; k < with.size(); ++k)
            out.segment<3>(Eigen::Index(2 * sights_.size() + 3 * k)) = of_outline(k, with[k]);
        return out;
    }
    Vec2d residual(size_t i, const std::vector<LampPlace>& at, const std::vector<Circle>& with) const {
        return (expected(sights_[i], at, with) - sights_[i].seen.place) / sights_[i].seen.deviation;
    }
    Vec3d of_outline(size_t k, const Circle& now) const {
        const Vec2d off = now.centre - found_[k].centre;
        return Vec3d(off.x(), off.y(), now.radius - found_[k].radius) / found_[k].deviation;
    }
    /// By differences: a highlight depends on its lamp and its sphere alone.
    Eigen::MatrixXd jacobian_of(const Eigen::VectorXd& residuals) const {
        const Eigen::Index lamps = Eigen::Index(places.size()) * numbers_;
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(residuals.size(), lamps + 3 * Eigen::Index(outlines.size()));
        std::vector<LampPlace> at = places;
        std::vector<Circle> with = outlines;
        for (size_t i = 0; i < sights_.size(); ++i) {
            const Eigen::Index row = Eigen::Index(2 * i);
            const Sight& s = sights_[i];
            for (int k = 0; k < numbers_; ++k) {
                const double step =
                    k == 2 ? 1e-5 * places[s.lamp].closeness + 1e-9 / frame_->pixel / frame_->width : 1e-5;
                at[s.lamp] = places[s.lamp].moved(step * Vec3d::Unit(k));
                out.block<2, 1>(row, Eigen::Index(s.lamp) * numbers_ + k) =
                    (residual(i, at, with) - residuals.segment<2>(row)) / step;
            }
            at[s.lamp] = places[s.lamp];
            for (int k = 0; k < 3; ++k) {
                constexpr double step = 1e-4;
                with[s.sphere] = changed(outlines[s.sphere], step * Vec3d::Unit(k));
                out.block<2, 1>(row, lamps + 3 * Eigen::Index(s.sphere) + k) =
                    (residual(i, at, with) - residuals.segment<2>(row)) / step;
            }
            with[s.sphere] = outlines[s.sphere];
        }
        for (size_t k = 0; k < outlines.size(); ++k)
            out.block<3, 3>(Eigen::Index(2 * sights_.size() + 3 * k), lamps + 3 * Eigen::Index(k)) =
                Mat3d::Identity() / found_[k].deviation;
        return out;
    }
    static Circle changed(Circle circle, const Vec3d& by) {
        circle.centre += by.head<2>();
        circle.radius += by.z();
        return circle;
    }
    std::pair<std::vector<LampPlace>, std::vector<Circle>> stepped(const Eigen::VectorXd& change) const {
        std::vector<LampPlace> at;
        for (size_t i = 0; i < places.size(); ++i) {
            Vec3d step = Vec3d::Zero();
            step.head(numbers_) = change.segment(Eigen::Index(i) * numbers_, numbers_);
            at.push_back(places[i].moved(step));
        }
        std::vector<Circle> with;
        const Eigen::Index lamps = Eigen::Index(places.size()) * numbers_;
        for (size_t k = 0; k < outlines.size(); ++k)
            with.push_back(changed(outlines[k], change.segment<3>(lamps + 3 * Eigen::Index(k))));
        return {std::move(at), std::move(with)};
    }

    std::vector<Circle> found_;
    std::vector<Sight> sights_;
    const PictureFrame* frame_;
    int numbers_;  ///< of a lamp: 2 of its direction, and its closeness
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
    const Eigen::SelfAdjointEigenSolver<Mat3d> eigen(across * covariance * across, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(eigen.eigenvalues()[2], 0.0)) / length * 180 / std::numbers::pi;
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
        std::vector<size_t> images;
        std::vector<Adjustment::Sight> sights;
        for (size_t i = 0; i < highlights.size(); ++i) {
            const auto count =
                size_t(std::ranges::count_if(highlights[i], [](const auto& h) { return h.has_value(); }));
            if (left_out[i] || count < (near ? 2 : 1)) continue;
            for (size_t s = 0; s < outlines.size(); ++s)
                if (highlights[i][s]) sights.push_back({images.size(), s, *highlights[i][s]});
            images.push_back(i);
        }
        Adjustment a(outlines, std::move(sights), images.size(), frame, near);
        if (!images.empty()) a.solve();
        SphereLamps out{.images = {images.begin(), images.end()},
                        .lamps = {},
                        .covariance = {},
                        .outlines = a.outlines,
                        .near = near};
        for (size_t k = 0; k < images.size(); ++k) out.lamps.push_back(a.lamp(k));
        out.covariance = a.steps_covariance();
        return out;
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
