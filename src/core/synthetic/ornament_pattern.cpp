#include "synthetic/ornament_pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/rng.h"

namespace radiafit {
namespace {

using Material = OrnamentMaterial;
using Point = OrnamentPattern::Point;
constexpr double pi = std::numbers::pi;

// Latitudes, radians: a frieze around the equator, a rope on either side, leaves up to the caps.
constexpr double rope_from = 0.27, rope_to = 0.39, cap_from = 1.22;
constexpr int rosettes = 16, leaf_count = 8, flutes = 20;

/// An arch over [-1, 1] of height 1, 0 outside.
double arch(double x) { return std::max(0.0, 1 - x * x); }
/// Rises from 0 at the rim (distance 0) to 1 at `width` and beyond.
double cushion(double distance, double width) {
    const double rest = 1 - std::clamp(distance / width, 0.0, 1.0);
    return 1 - rest * rest;
}
/// The angle from the nearest of `count` evenly spaced meridians.
double from_meridian(double longitude, int count, double shift = 0) {
    const double spacing = 2 * pi / count;
    const double steps = longitude / spacing - shift;
    return (steps - std::round(steps)) * spacing;
}

/// A leaf from t = 0 to 1 along its rib; `aside` the distance from the rib in the same units as `width`. A height of 0
/// means outside.
Point leaf(double t, double aside, double width, double rim) {
    if (t <= 0 || t >= 1) return {};
    const double outline = std::pow(std::sin(pi * std::pow(t, 0.8)), 0.85) * (1.12 - 0.35 * t);
    const double lobes = 1 + 0.10 * std::cos(2 * pi * 5 * t);
    const double half = width * outline * lobes, inside = half - std::abs(aside);
    if (inside <= 0) return {};
    if (inside < rim) return {Material::gold, 0.014 * arch(2 * inside / rim - 1) + 0.004, 0};
    const double depth = inside - rim;
    const double shade = std::clamp(std::abs(aside) / std::max(half - rim, 1e-3), 0.0, 1.0);
    const double rib = 0.10 * width * (1.1 - t);
    if (std::abs(aside) < rib) return {Material::gold, 0.022 + 0.012 * arch(aside / rib), 0};
    const double vein = std::pow(0.5 + 0.5 * std::cos(2 * pi * (8 * t - 1.4 * shade)), 4);
    return {Material::green, 0.004 + 0.020 * cushion(depth, 0.07) - 0.0045 * vein, shade};
}

}  // namespace

double OrnamentPattern::Noise::operator()(const Vec3d& x) const {
    double sum = 0;
    for (size_t i = 0; i < waves.size(); ++i) sum += std::sin(waves[i].dot(x) + phases[i]);
    const double spread = std::sqrt(0.5 * double(waves.size()));  // standard deviation of the sum
    return 0.5 + 0.5 * std::tanh(0.8 * sum / spread);
}

OrnamentPattern::Noise OrnamentPattern::make_noise(uint64_t seed, uint64_t stream, double frequency) const {
    Rng rng(seed, stream);
    Noise noise;
    for (int i = 0; i < 12; ++i) {
        const Vec3d random(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
        noise.waves.push_back(frequency * random);
        noise.phases.push_back(2 * pi * double(rng.uniform()));
    }
    return noise;
}

OrnamentPattern::OrnamentPattern(uint64_t seed) : turn_(2 * pi * double(Rng(seed, 5).uniform())) {
    for (size_t i = 0; i < wear_.size(); ++i) wear_[i] = make_noise(seed, 6 + i, 9);
}

Point OrnamentPattern::frieze(double longitude, double latitude) const {
    const double x = from_meridian(longitude, rosettes) * std::cos(latitude), y = latitude;
    const double radius = std::hypot(x, y), angle = std::atan2(y, x);
    if (radius < 0.040) return {Material::green, 0.012 + 0.020 * arch(radius / 0.040), radius / 0.040};
    const double petal = std::abs(std::cos(2.5 * (angle - 0.5 * pi)));
    const double inside = 0.155 * (0.55 + 0.45 * std::sqrt(petal)) - radius;
    if (inside > 0) return {Material::gold, 0.020 * cushion(inside, 0.06) * (0.6 + 0.4 * petal), 0};
    const double between = from_meridian(longitude, rosettes, 0.5) * std::cos(latitude);
    const Point blade = leaf(0.5 + y / 0.48, between, 0.045, 0.012);
    if (blade.height > 0) return blade;
    return {};
}

Point OrnamentPattern::leaves(double longitude, double above) const {
    const double narrowing = std::cos(rope_to + above);
    const double length = cap_from - rope_to;
    const Point large =
        leaf((above + 0.02) / (0.99 * length), from_meridian(longitude, leaf_count) * narrowing, 0.235, 0.026);
    if (large.height > 0) return large;
    const Point small =
        leaf((above + 0.02) / (0.62 * length), from_meridian(longitude, leaf_count, 0.5) * narrowing, 0.090, 0.020);
    if (small.height > 0) return small;
    // A gold bead above each small leaf.
    const double x = from_meridian(longitude, leaf_count, 0.5) * narrowing, y = above - 0.74 * length;
    const double bead = std::hypot(x, y) / 0.045;
    if (bead < 1) return {Material::gold, 0.030 * arch(bead), 0};
    return {};
}

Point OrnamentPattern::cap(const Vec3d& x, double longitude, double above) const {
    constexpr double ring = 0.05;
    if (above < ring) return {Material::gold, 0.024 * arch(2 * above / ring - 1), 0};
    const double axis_distance = std::hypot(x.x(), x.y());
    const double flute = 0.014 * std::abs(std::sin(0.5 * flutes * longitude)) * std::min(1.0, axis_distance / 0.25);
    const double turned = std::abs(x.z()) > 0.76 ? 0.006 * std::cos(2 * pi * x.z() / 0.05) : 0;
    return {Material::gold, flute + turned, 0};
}

Point OrnamentPattern::at(const Vec3d& x) const {
    const double latitude = std::asin(std::clamp(x.z() / std::max(x.norm(), 1e-9), -1.0, 1.0)),
                 away = std::abs(latitude);
    // The lower half is turned by half a leaf.
    const double longitude = std::atan2(x.y(), x.x()) + turn_ + (latitude < 0 ? pi / leaf_count : 0);
    if (away < rope_from) return frieze(longitude, latitude);
    if (away < rope_to) {
        const double across = 2 * (away - rope_from) / (rope_to - rope_from) - 1;
        const double strand = 0.70 + 0.30 * std::sin(36 * longitude + 2.5 * (latitude < 0 ? -across : across));
        return {Material::gold, 0.034 * arch(across) * strand, 0};
    }
    return away < cap_from ? leaves(longitude, away - rope_to) : cap(x, longitude, away - cap_from);
}

Vec3d OrnamentPattern::normal(const Vec3d& x, const Vec3d& normal, double step) const {
    Vec3d gradient;
    for (int i = 0; i < 3; ++i) {
        const Vec3d along = step * Vec3d::Unit(i);
        gradient[i] = (at(x + along).height - at(x - along).height) / (2 * step);
    }
    constexpr double steepest = 1.2;
    gradient -= normal.dot(gradient) * normal;
    gradient *= std::min(1.0, steepest / std::max(gradient.norm(), 1e-9));
    return (normal - gradient).normalized();
}

TexelParameters OrnamentPattern::parameters(const Vec3d& x) const {
    const Point point = at(x);
    const double w0 = wear_[0](x), w1 = wear_[1](x), w2 = wear_[2](x), w3 = wear_[3](x);
    const auto nine = [](const Vec3d& diffuse, const Vec3d& specular, double a, double b, double c) {
        TexelParameters p;
        for (int i = 0; i < 3; ++i) p[size_t(i)] = float(diffuse[i]), p[size_t(3 + i)] = float(specular[i]);
        p[6] = float(a), p[7] = float(b), p[8] = float(c);
        return p;
    };
    switch (point.material) {
        case Material::gold:
            return nine((0.7 + 0.6 * w0) * Vec3d(0.240, 0.145, 0.035), (0.70 + 0.30 * w1) * Vec3d(0.66, 0.47, 0.17), -1,
                        0.93 + 0.07 * w2, 6 * std::pow(6.0, w3));
        case Material::green: {
            const Vec3d inner(0.010, 0.085, 0.035), outer(0.035, 0.200, 0.050);
            return nine((0.8 + 0.4 * w0) * (inner + point.shade * (outer - inner)),
                        (0.6 + 0.4 * w1) * Vec3d(0.14, 0.46, 0.20), -0.86 - 0.14 * w2, 1, 5 * std::pow(3.6, w3));
        }
        default:
            return nine((0.92 + 0.08 * w0) * Vec3d(0.74, 0.71, 0.66), (0.02 + 0.01 * w1) * Vec3d::Ones(),
                        0.20 + 0.30 * w2, 0, 20 + 30 * w3);
    }
}

}  // namespace radiafit
