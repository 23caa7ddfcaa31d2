#include "lamps/sphere_outline.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/parallel.h"
#include "base/statistics.h"
#include "lamps/connected_pixels.h"
#include "lamps/least_squares.h"

namespace radiafit::tools {
namespace {

constexpr int rays = 360;
constexpr double band = 1.0 / 6;            // of the radius, to either side, where an outline is looked for
constexpr double least_share = 0.5;         // of the rays that have their edge on the circle
constexpr double highlights_within = 0.92;  // of an outline's radius: those of lamps just above the plane
constexpr double least_spots = 0.25;        // for each image; those of lamps nearby are one
constexpr double most_spots = 1.6;          // for each image: noise parts some
constexpr double spot_over_mean = 6;        // of a spot's brightest value

Vec2d ray(int i) {
    const double angle = 2 * std::numbers::pi * i / rays;
    return {std::cos(angle), std::sin(angle)};
}

/// The circle of least squares of the points' distances from it, those beyond four medians left out.
struct FittedCircle {
    Circle circle;
    size_t kept = 0;
};
FittedCircle fit_circle(const std::vector<Vec2d>& points, Circle circle) {
    size_t kept = 0;
    for (int step = 0; step < 30; ++step) {
        std::vector<double> off;
        for (const Vec2d& p : points) off.push_back(std::abs((p - circle.centre).norm() - circle.radius));
        const double most = std::max(4 * median(off), 0.05);
        Mat3d matrix = Mat3d::Zero();
        Vec3d right = Vec3d::Zero();
        double squares = 0;
        kept = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            if (off[i] > most) continue;
            const Vec2d from = points[i] - circle.centre;
            const double distance = std::max(from.norm(), 1e-9), residual = distance - circle.radius;
            const Vec3d slope(-from.x() / distance, -from.y() / distance, -1);
            matrix += slope * slope.transpose();
            right -= slope * residual;
            squares += residual * residual;
            ++kept;
        }
        if (kept < 4) break;
        const Eigen::LDLT<Mat3d> solver(matrix);
        const Vec3d change = solver.solve(right);
        circle.centre += change.head<2>();
        circle.radius += change.z();
        const double variance = squares / double(kept - 3);
        circle.deviation = std::sqrt(variance * Mat3d(solver.solve(Mat3d::Identity())).diagonal().maxCoeff());
        if (change.norm() < 1e-6) break;
    }
    return {circle, kept};
}

}  // namespace

void SphereFinder::add(const LuminanceImage& image) {
    if (images_++ == 0) {
        sum_ = brightest_ = edges_ = image;
        for (LuminanceImage* i : {&sum_, &brightest_, &edges_}) std::fill(i->values.begin(), i->values.end(), 0.0f);
    }
    double mean = 0;
    for (size_t p = 0; p < image.values.size(); ++p) {
        sum_.values[p] += image.values[p];
        brightest_.values[p] = std::max(brightest_.values[p], image.values[p]);
        mean += double(image.values[p]) / double(image.values.size());
    }
    const float scale = static_cast<float>(1 / std::max(mean, 1e-12));
    parallel_for(size_t(std::max(image.height - 2, 0)), 16, [&](size_t row, int) {
        const int y = int(row) + 1;
        for (int x = 1; x + 1 < image.width; ++x) {
            const float dx = image.at(x + 1, y) - image.at(x - 1, y), dy = image.at(x, y + 1) - image.at(x, y - 1);
            // a highlight is no edge of the scene
            edges_.values[size_t(y) * size_t(image.width) + size_t(x)] +=
                std::min(0.5f * std::hypot(dx, dy) * scale, 1.0f);
        }
    });
}

std::vector<Vec2d> SphereFinder::spots() const {
    const float largest = *std::max_element(brightest_.values.begin(), brightest_.values.end());
    const auto is_spot = [&](int x, int y) {
        const float most = brightest_.at(x, y);
        return most > 0.5f * largest && double(most) * double(images_) > spot_over_mean * double(sum_.at(x, y));
    };
    std::vector<Vec2d> out;
    for (const ConnectedPixels& spot : connected_pixels(brightest_.width, brightest_.height, is_spot)) {
        Vec2d sum = Vec2d::Zero();
        for (const auto& [x, y] : spot) sum += Vec2d(x + 0.5, y + 0.5);
        out.push_back(sum / double(spot.size()));
    }
    return out;
}

namespace {

/// Means of 2 x 2 pixels.
LuminanceImage halved(const LuminanceImage& image) {
    LuminanceImage out{image.width / 2, image.height / 2, {}};
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x)
            out.values.push_back(0.25f * (image.at(2 * x, 2 * y) + image.at(2 * x + 1, 2 * y) +
                                          image.at(2 * x, 2 * y + 1) + image.at(2 * x + 1, 2 * y + 1)));
    return out;
}

/// How much stronger edges are along a circle than a little beyond. Within an outline, mirrored surroundings have many.
double contrast_of(const LuminanceImage& edges, const Circle& circle) {
    const double gap = std::max(2.0, 0.06 * circle.radius);
    double sum = 0;
    for (int i = 0; i < rays; i += 3)
        sum += edges.sample(circle.centre + circle.radius * ray(i)) -
               edges.sample(circle.centre + (circle.radius + gap) * ray(i));
    return sum;
}

Circle scaled(const Circle& circle, double by) {
    return {by * circle.centre, by * circle.radius, by * circle.deviation};
}

/// A better one in steps of such a size, by turns, until there is none.
Circle climbed(const LuminanceImage& edges, Circle circle, double step) {
    double most = contrast_of(edges, circle);
    for (int round = 0; round < 20; ++round) {
        Circle best = circle;
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dr = -1; dr <= 1; ++dr) {
                    const Circle other{circle.centre + step * Vec2d(dx, dy), circle.radius + step * dr};
                    if (other.radius < 3) continue;
                    if (const double contrast = contrast_of(edges, other); contrast > most)
                        most = contrast, best = other;
                }
        if (best.centre == circle.centre && best.radius == circle.radius) break;
        circle = best;
    }
    return circle;
}

/// The circle of strongest edges with its centre within `reach` of a place, for each radius in steps.
struct Ranked {
    Circle circle;
    double contrast = 0;
};
std::vector<Ranked> best_of_radii(const LuminanceImage& edges, const Vec2d& centre, double reach, double first,
                                  double last, const std::function<bool(const Circle&)>& allowed) {
    constexpr double step = 0.75;
    std::vector<Ranked> out(size_t(std::max(0.0, std::floor((last - first) / step)) + 1));
    parallel_for(out.size(), 1, [&](size_t i, int) {
        const double radius = first + double(i) * step;
        for (double dx = -reach; dx <= reach; dx += step)
            for (double dy = -reach; dy <= reach; dy += step) {
                const Circle circle{centre + Vec2d(dx, dy), radius};
                if (!allowed(circle)) continue;
                if (const double contrast = contrast_of(edges, circle); contrast > out[i].contrast)
                    out[i] = {circle, contrast};
            }
    });
    return out;
}

/// Where the rim is, by the mean strength of edges at each distance from the centre: a peak of some width at the rim,
/// one level within, of mirrored surroundings, and another beyond. The peak alone would lie within the rim. At the rim
/// itself a mirror shrinks what it shows without bound, so that the level within ends before it, by about that width.
double rim_radius(const LuminanceImage& edges, const Circle& circle) {
    constexpr double reach = 3, step = 0.1;
    std::vector<double> off, strength;
    for (double r = -reach; r <= reach; r += step) {
        double sum = 0;
        for (int i = 0; i < rays; ++i) sum += edges.sample(circle.centre + (circle.radius + r) * ray(i)) / rays;
        off.push_back(r);
        strength.push_back(sum);
    }
    // shift, logarithm of the width, peak, level beyond, the one within over it
    using Vec5 = Eigen::Matrix<double, 5, 1>;
    const auto expected = [](const Vec5& p, double r) {
        const double x = (r - p[0]) / std::exp(p[1]);
        return p[2] * std::exp(-0.5 * x * x) + p[3] + 0.5 * p[4] * std::erfc((x + 1) / std::numbers::sqrt2);
    };
    const auto residuals = [&](const Vec5& p) {
        Eigen::VectorXd out(Eigen::Index(off.size()));
        for (size_t i = 0; i < off.size(); ++i) out[Eigen::Index(i)] = expected(p, off[i]) - strength[i];
        return out;
    };
    const auto jacobian = [&](const Vec5& p, const Eigen::VectorXd& now) {
        constexpr double by = 1e-6;
        Eigen::MatrixXd out(now.size(), 5);
        for (int k = 0; k < 5; ++k) out.col(k) = (residuals(p + by * Vec5::Unit(k)) - now) / by;
        return out;
    };
    Vec5 p(0, 0, *std::ranges::max_element(strength) - strength.front(), strength.back(),
           strength.front() - strength.back());
    minimize(p, residuals, jacobian, [](const Vec5& from, const Eigen::VectorXd& step) { return Vec5(from + step); });
    return std::abs(p[0]) < 1 ? circle.radius + p[0] : circle.radius;
}

}  // namespace

std::optional<Circle> SphereFinder::refined(const Circle& about) const {
    if (images_ == 0) return {};
    const std::vector<LuminanceImage> levels = edge_levels(about.radius);
    const double by = std::pow(2.0, double(levels.size() - 1));
    const Circle small = scaled(about, 1 / by);
    const std::vector<Ranked> ranked =
        best_of_radii(levels.back(), small.centre, band * small.radius, (1 - band) * small.radius,
                      (1 + band) * small.radius, [](const Circle&) { return true; });
    const Ranked& most = *std::ranges::max_element(ranked, {}, &Ranked::contrast);
    if (!(most.contrast > 0)) return {};
    return sharpened(levels, most.circle);
}

std::vector<LuminanceImage> SphereFinder::edge_levels(double radius) const {
    constexpr double enough = 28;  // pixels, in which a circle is looked for
    std::vector<LuminanceImage> levels = {edges_};
    for (; radius > enough && std::min(levels.back().width, levels.back().height) > 16; radius /= 2)
        levels.push_back(halved(levels.back()));
    return levels;
}

std::optional<Circle> SphereFinder::sharpened(const std::vector<LuminanceImage>& levels, Circle circle) {
    for (size_t level = levels.size(); level-- > 0;) {
        circle = climbed(levels[level], circle, 0.5);
        if (level > 0) circle = scaled(circle, 2);
    }
    circle = climbed(levels.front(), circle, 0.25);
    const LuminanceImage& edges = levels.front();
    for (const double reach : {std::max(0.03 * circle.radius, 2.0), 1.5}) {
        constexpr double step = 0.25;
        const int count = 2 * int(reach / step) + 1;
        std::vector<Vec2d> points;
        for (int i = 0; i < rays; ++i) {
            std::vector<double> edge;
            for (int k = 0; k < count; ++k)
                edge.push_back(edges.sample(circle.centre + (circle.radius - reach + k * step) * ray(i)));
            const auto top = std::max_element(edge.begin(), edge.end()) - edge.begin();
            if (top == 0 || top + 1 == count) continue;
            const double before = edge[size_t(top - 1)], at = edge[size_t(top)], after = edge[size_t(top + 1)];
            const double bend = before + after - 2 * at;
            const double shift = bend < 0 ? 0.5 * (before - after) / bend : 0;
            points.push_back(circle.centre + (circle.radius - reach + (double(top) + shift) * step) * ray(i));
        }
        if (double(points.size()) < least_share * rays) return {};
        const FittedCircle fitted = fit_circle(points, circle);
        if (double(fitted.kept) < least_share * rays || !(fitted.circle.radius > 2)) return {};
        circle = fitted.circle;
    }
    circle.radius = rim_radius(edges, circle);
    return circle;
}

std::optional<Circle> SphereFinder::outline_around(const std::vector<Vec2d>& highlights) const {
    Vec2d middle = Vec2d::Zero();
    for (const Vec2d& h : highlights) middle += h / double(highlights.size());
    double spread = 0;
    for (const Vec2d& h : highlights) spread = std::max(spread, (h - middle).norm());
    const std::vector<LuminanceImage> levels = edge_levels(1.5 * spread);
    const double by = std::pow(2.0, double(levels.size() - 1));
    const auto holds_highlights = [&](double within) {
        return [&, within](const Circle& circle) {
            return std::ranges::all_of(
                highlights, [&](const Vec2d& h) { return (h / by - circle.centre).norm() < within * circle.radius; });
        };
    };
    const std::vector<Ranked> ranked =
        best_of_radii(levels.back(), middle / by, 1.5 * spread / by, spread / by, 4 * spread / by, holds_highlights(1));
    const Ranked& most = *std::ranges::max_element(ranked, {}, &Ranked::contrast);
    if (!(most.contrast > 0)) return {};
    // A mirror shows the horizon as a circle within its outline, which may be the stronger one: from there on outwards,
    // the last that stands out.
    Circle outline = most.circle;
    const double reach = 0.1 * most.circle.radius;
    const std::vector<Ranked> beyond =
        best_of_radii(levels.back(), most.circle.centre, std::max(reach, 0.75), most.circle.radius,
                      1.7 * most.circle.radius, holds_highlights(highlights_within));
    for (size_t i = 0; i < beyond.size(); ++i) {
        const double contrast = beyond[i].contrast;
        if (contrast >= 0.4 * most.contrast && (i == 0 || contrast >= beyond[i - 1].contrast) &&
            (i + 1 == beyond.size() || contrast >= beyond[i + 1].contrast))
            outline = beyond[i].circle;
    }
    return sharpened(levels, outline);
}

std::vector<Circle> SphereFinder::find(size_t count) const {
    if (images_ == 0) return {};
    const std::vector<Vec2d> all = spots();
    const double side = std::min(brightest_.width, brightest_.height);
    // Groups of spots that lie apart from others, those of many first.
    std::vector<std::vector<uint32_t>> groups;
    for (double radius = std::max(4.0, side / 100); radius <= side / 6; radius *= 1.15)
        for (const Vec2d& about : all) {
            std::vector<uint32_t> group;
            bool apart = true;
            for (size_t i = 0; i < all.size(); ++i) {
                const double distance = (all[i] - about).norm();
                if (distance < radius) group.push_back(uint32_t(i));
                apart = apart && !(distance >= radius && distance < 1.4 * radius);
            }
            const double share = double(group.size()) / double(images_);
            if (apart && group.size() >= 3 && share >= least_spots && share <= most_spots)
                groups.push_back(std::move(group));
        }
    std::ranges::sort(groups,
                      [](const auto& a, const auto& b) { return a.size() != b.size() ? a.size() > b.size() : a < b; });
    groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
    std::vector<Circle> found;
    for (const auto& group : groups) {
        if (found.size() == count) break;
        std::vector<Vec2d> highlights;
        for (const uint32_t i : group) highlights.push_back(all[i]);
        const bool known = std::ranges::any_of(found, [&](const Circle& c) {
            return std::ranges::any_of(highlights, [&](const Vec2d& h) { return (h - c.centre).norm() < c.radius; });
        });
        if (known) continue;
        if (const std::optional<Circle> circle = outline_around(highlights)) found.push_back(*circle);
    }
    return found;
}

}  // namespace radiafit::tools
