#pragma once
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/linear.h"

/// Lenses that are no pinhole: where a camera shows what a pinhole would show elsewhere.
namespace radiafit::tools {

/// A point (u, v) of the plane at depth 1, as a pinhole has it, becomes in three steps the point (x, y) that the focal
/// lengths and the principal point turn into pixels. With r the distance from the axis:
/// 1. if `bend` is not 0, by angle: (u, v) times atan(bend r) / (angle r); bend 1 and angle 1 are a fisheye, bend
///    2 tan(w / 2) and angle w are COLMAP's FOV;
/// 2. radially, by (1 + k1 r^2 + k2 r^4 + k3 r^6 + k4 r^8) / (1 + d1 r^2 + d2 r^4 + d3 r^6);
/// 3. with tangential (p1, p2) and thin-prism (s1, s2) terms: x += 2 p1 u v + p2 (r^2 + 2 u^2) + s1 r^2, y likewise.
/// These are the models of OpenCV's calibration and COLMAP (sensor/models.h) in one.
struct LensCoefficients {
    double bend = 0, angle = 1;
    std::array<double, 4> radial{};   ///< k1 to k4
    std::array<double, 3> divisor{};  ///< d1 to d3: k4 to k6 of FULL_OPENCV
    std::array<double, 2> tangential{}, prism{};

    bool operator==(const LensCoefficients&) const = default;
};

/// A distorted point and its derivatives by u and v. `valid`: (u, v) lies where the model grows with the distance from
/// the axis. Farther out it folds over: two directions would share a pixel, which no lens does.
struct DistortedPoint {
    double x, y;
    double x_u, x_v, y_u, y_v;
    bool valid;
};

class Lens {
public:
    /// name: the model and its coefficients as the calibration has them, for messages: "SIMPLE_RADIAL (-0.06)".
    Lens(std::string name, const LensCoefficients& coefficients);

    const std::string& name() const { return name_; }
    bool distorts() const { return c_ != LensCoefficients{}; }
    DistortedPoint distort(double u, double v) const;
    /// The point that distort() takes to (x, y), to 1e-12 of its distance; none where the model doesn't reach.
    std::optional<Vec2d> undistort(const Vec2d& distorted) const;

    bool operator==(const Lens& other) const { return c_ == other.c_; }

private:
    DistortedPoint distort_bent(double u, double v) const;  // steps 2 and 3
    double radius(double r) const;                          // step 2 of a radius

    std::string name_;
    LensCoefficients c_;
    double reach_ = std::numeric_limits<double>::infinity();  // radii after step 1 up to which step 2 grows
};

/// The lens of one of COLMAP's camera models, by its name there and the parameters behind the principal point. Names
/// without a lens: SIMPLE_PINHOLE, PINHOLE, and those that are not known.
std::optional<Lens> colmap_lens(std::string_view model, std::span<const double> coefficients);

}  // namespace radiafit::tools
