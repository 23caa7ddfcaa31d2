#include "synthetic/solid.h"

#include <algorithm>
#include <cmath>

namespace radiafit {
namespace {

/// Smooth minimum (Quilez): equals min(a, b) where they differ by more than `width`.
double smooth_min(double a, double b, double width) {
    const double h = std::max(0.0, width - std::abs(a - b)) / width;
    return std::min(a, b) - 0.25 * h * h * width;
}

}  // namespace

void Solid::ellipsoid(const Vec3d& center, const Vec3d& radii, double blend, bool carve) {
    parts_.push_back({Kind::ellipsoid, center, radii, 0, 0, blend, carve});
}

void Solid::round_cone(const Vec3d& a, double radius_a, const Vec3d& b, double radius_b, double blend) {
    parts_.push_back({Kind::round_cone, a, b, radius_a, radius_b, blend, false});
}

void Solid::floor(double height, double blend) {
    parts_.push_back({Kind::floor, {0, 0, height}, Vec3d::Zero(), 0, 0, blend, true});
}

double Solid::distance(const Part& part, const Vec3d& x) {
    if (part.kind == Kind::floor) return x.z() - part.a.z();  // carved: what lies below is taken away
    if (part.kind == Kind::ellipsoid) {
        // First-order distance: F / |grad F| of F = |x / r| - 1, rewritten to stay finite in the centre.
        const Vec3d scaled = (x - part.a).cwiseQuotient(part.b);
        const double k0 = scaled.norm(), k1 = scaled.cwiseQuotient(part.b).norm();
        return k1 > 1e-9 ? k0 * (k0 - 1) / k1 : -part.b.minCoeff();
    }
    // A ball whose centre and radius slide along the axis, to where its surface is nearest.
    const Vec3d axis = part.b - part.a, offset = x - part.a;
    const double length = axis.norm(), along = offset.dot(axis) / length;
    const double across = std::sqrt(std::max(0.0, offset.squaredNorm() - along * along));
    const double slope = (part.ra - part.rb) / length;
    const double t = std::clamp((along + across * slope / std::sqrt(1 - slope * slope)) / length, 0.0, 1.0);
    const double beside = along - t * length;
    return std::sqrt(across * across + beside * beside) - (part.ra + t * (part.rb - part.ra));
}

double Solid::value(const Vec3d& x) const {
    double f = 1e9;
    for (const Part& part : parts_) {
        const double d = distance(part, x);
        f = part.carve ? -smooth_min(-f, d, part.blend) : smooth_min(f, d, part.blend);
    }
    return f;
}

Vec3d Solid::gradient(const Vec3d& x) const {
    constexpr double h = 1e-4;
    Vec3d g;
    for (int i = 0; i < 3; ++i) g[i] = (value(x + h * Vec3d::Unit(i)) - value(x - h * Vec3d::Unit(i))) / (2 * h);
    return g;
}

Vec3d Solid::outermost(const Vec3d& origin, const Vec3d& direction) const {
    double outside = 3, inside = 3;
    // Steps shorter than f: the first-order distance may overestimate.
    while (inside > 0) {
        const double f = value(origin + inside * direction);
        if (f < 0) break;
        outside = inside;
        inside -= std::max(0.5 * f, 1e-3);
    }
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (inside + outside);
        (value(origin + middle * direction) < 0 ? inside : outside) = middle;
    }
    return origin + inside * direction;
}

Vec3d Solid::project(Vec3d x) const {
    for (int i = 0; i < 8; ++i) {
        const double f = value(x);
        if (std::abs(f) < 1e-6) break;
        const Vec3d g = gradient(x);
        x -= std::clamp(f, -0.05, 0.05) * g / std::max(g.squaredNorm(), 0.05);  // Newton, never far in one step
    }
    return x;
}

}  // namespace radiafit
