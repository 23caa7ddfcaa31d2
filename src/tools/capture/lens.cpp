#include "capture/lens.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace radiafit::tools {
namespace {

/// A polynomial in t = r^2 whose constant is 1, and its derivative.
template <size_t N>
std::array<double, 2> polynomial(const std::array<double, N>& k, double t) {
    double value = 0, slope = 0;
    for (size_t i = N; i-- > 0;) {
        slope = slope * t + value;
        value = value * t + k[i];
    }
    return {1 + t * value, value + t * slope};
}

/// The factor s of step 2 at t = r^2, and ds/dt.
std::array<double, 2> radial_factor(const LensCoefficients& c, double t) {
    const auto [n, dn] = polynomial(c.radial, t);
    if (c.divisor == std::array<double, 3>{}) return {n, dn};
    const auto [d, dd] = polynomial(c.divisor, t);
    return {n / d, (dn * d - n * dd) / (d * d)};
}

bool grows(const LensCoefficients& c, double r) {
    const double t = r * r;
    const auto [s, ds] = radial_factor(c, t);
    return polynomial(c.divisor, t)[0] > 0 && s + 2 * t * ds > 0;
}

/// The radius from which on step 2 no longer grows. The directions up to 90 degrees from the axis are looked through
/// in small steps, and the first change is then found by halving.
double find_reach(const LensCoefficients& c) {
    constexpr int steps = 4096;
    const double widest = M_PI / 2;
    const auto radius = [&](int i) {
        const double a = widest * i / steps;
        return c.bend != 0 ? std::atan(c.bend * std::tan(a)) / c.angle : std::tan(a);
    };
    for (int i = 1; i < steps; ++i) {
        double high = radius(i), low = radius(i - 1);
        if (grows(c, high)) continue;
        for (int k = 0; k < 80; ++k) (grows(c, 0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
        return low;
    }
    return std::numeric_limits<double>::infinity();
}

}  // namespace

Lens::Lens(std::string name, const LensCoefficients& coefficients) : name_(std::move(name)), c_(coefficients) {
    reach_ = find_reach(c_);
}

double Lens::radius(double r) const { return r * radial_factor(c_, r * r)[0]; }

DistortedPoint Lens::distort_bent(double u, double v) const {
    const double uu = u * u, vv = v * v, uv = u * v, t = uu + vv;
    const auto [s, ds] = radial_factor(c_, t);
    const auto [p1, p2] = c_.tangential;
    const auto [s1, s2] = c_.prism;
    DistortedPoint d;
    d.x = u * s + 2 * p1 * uv + p2 * (t + 2 * uu) + s1 * t;
    d.y = v * s + 2 * p2 * uv + p1 * (t + 2 * vv) + s2 * t;
    const double across = 2 * uv * ds + 2 * (p1 * u + p2 * v);
    d.x_u = s + 2 * uu * ds + 2 * p1 * v + 6 * p2 * u + 2 * s1 * u;
    d.x_v = across + 2 * s1 * v;
    d.y_u = across + 2 * s2 * u;
    d.y_v = s + 2 * vv * ds + 2 * p2 * u + 6 * p1 * v + 2 * s2 * v;
    d.valid = t < reach_ * reach_ && d.x_u * d.y_v - d.x_v * d.y_u > 0;
    return d;
}

DistortedPoint Lens::distort(double u, double v) const {
    if (c_.bend == 0) return distort_bent(u, v);
    // a = atan(bend r) / (angle r) and its derivative by r^2; near the axis the first terms of its series.
    const double m = c_.bend, t = u * u + v * v, small = m * m * t;
    double a, da;
    if (small < 1e-6) {
        a = m / c_.angle * (1 - small / 3 + small * small / 5);
        da = m * m * m / c_.angle * (-1.0 / 3 + 2 * small / 5);
    } else {
        const double r = std::sqrt(t);
        a = std::atan(m * r) / (c_.angle * r);
        da = (m / (c_.angle * (1 + small)) - a) / (2 * t);
    }
    const DistortedPoint b = distort_bent(a * u, a * v);
    const double u_u = a + 2 * da * u * u, u_v = 2 * da * u * v, v_v = a + 2 * da * v * v;
    DistortedPoint d = b;
    d.x_u = b.x_u * u_u + b.x_v * u_v;
    d.x_v = b.x_u * u_v + b.x_v * v_v;
    d.y_u = b.y_u * u_u + b.y_v * u_v;
    d.y_v = b.y_u * u_v + b.y_v * v_v;
    d.valid = b.valid && a > 0;
    return d;
}

std::optional<Vec2d> Lens::undistort(const Vec2d& distorted) const {
    const double far = distorted.norm();
    if (!std::isfinite(far) || c_.bend * c_.angle < 0) return {};
    // The radius alone first, by halving: a start from which Newton's steps converge.
    double low = 0, high = std::isfinite(reach_) ? reach_ : 1;
    if (!std::isfinite(reach_))
        while (radius(high) < far && high < 1e9) high *= 2;
    for (int i = 0; i < 20; ++i) (radius(0.5 * (low + high)) < far ? low : high) = 0.5 * (low + high);
    Vec2d p = far > 0 ? Vec2d(distorted * (low / far)) : Vec2d::Zero();
    DistortedPoint at = distort_bent(p.x(), p.y());
    double error = (Vec2d(at.x, at.y) - distorted).norm();
    const double tolerance = 1e-13 * far;
    for (int i = 0; i < 50 && error > tolerance; ++i) {
        const double determinant = at.x_u * at.y_v - at.x_v * at.y_u;
        const double ex = distorted.x() - at.x, ey = distorted.y() - at.y;
        Vec2d step(at.y_v * ex - at.x_v * ey, at.x_u * ey - at.y_u * ex);
        step /= determinant;
        if (!step.allFinite()) break;
        bool better = false;
        for (int halvings = 0; halvings < 20 && !better; ++halvings, step *= 0.5) {
            const Vec2d next = p + step;
            const DistortedPoint there = distort_bent(next.x(), next.y());
            const double left = (Vec2d(there.x, there.y) - distorted).norm();
            if (!there.valid || !(left < error)) continue;
            p = next, at = there, error = left, better = true;
        }
        if (!better) break;
    }
    if (!at.valid || !(error <= 1e-11 * far)) return {};
    if (c_.bend == 0) return p;
    const double r = p.norm(), bent = c_.angle * r;
    if (bent >= M_PI / 2) return {};
    if (r > 0) p *= std::tan(bent) / (c_.bend * r);
    return p;
}

std::optional<Lens> colmap_lens(std::string_view model, std::span<const double> k) {
    LensCoefficients c;
    if (model == "FOV") {
        if (k[0] != 0) c.bend = 2 * std::tan(0.5 * k[0]), c.angle = k[0];
    } else {
        if (model.ends_with("FISHEYE")) c.bend = 1;
        const auto is_one_of = [&](auto... names) { return ((model == names) || ...); };
        if (is_one_of("SIMPLE_RADIAL", "SIMPLE_RADIAL_FISHEYE")) {
            c.radial = {k[0]};
        } else if (is_one_of("RADIAL", "RADIAL_FISHEYE")) {
            c.radial = {k[0], k[1]};
        } else if (model == "OPENCV") {
            c.radial = {k[0], k[1]};
            c.tangential = {k[2], k[3]};
        } else if (model == "FULL_OPENCV") {
            c.radial = {k[0], k[1], k[4]};
            c.divisor = {k[5], k[6], k[7]};
            c.tangential = {k[2], k[3]};
        } else if (model == "OPENCV_FISHEYE") {
            c.radial = {k[0], k[1], k[2], k[3]};
        } else if (model == "THIN_PRISM_FISHEYE") {
            c.radial = {k[0], k[1], k[4], k[5]};
            c.tangential = {k[2], k[3]};
            c.prism = {k[6], k[7]};
        } else {
            return {};
        }
    }
    Lens lens(fmt::format("{} ({})", model, fmt::join(k, ", ")), c);
    return lens.distorts() ? std::optional(std::move(lens)) : std::nullopt;
}

}  // namespace radiafit::tools
