#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "base/linear.h"

namespace radiafit {

/// A smooth solid: f(x) < 0 inside, f about the distance to the surface near it. A few ellipsoids and round cones,
/// joined and carved with rounded seams (polynomial smooth minimum). World space, z up, about 1 in radius.
class Solid {
public:
    /// Joins an ellipsoid to the solid, or carves it out. blend: width of the seam, > 0.
    void ellipsoid(const Vec3d& center, const Vec3d& radii, double blend, bool carve = false);
    /// A cone from a ball around a to a ball around b, and both balls.
    void round_cone(const Vec3d& a, double radius_a, const Vec3d& b, double radius_b, double blend);
    /// Cuts everything below the height away.
    void floor(double height, double blend);

    /// Names a tip that even a coarse mesh should reach: the outermost surface point on the
    /// way from the mesh's center to it.
    void tip(const Vec3d& x) { tips_.push_back(x); }
    const std::vector<Vec3d>& tips() const { return tips_; }

    double value(const Vec3d& x) const;
    Vec3d gradient(const Vec3d& x) const;  ///< central differences
    /// The surface point that lies outermost on the half-line from `origin` in the unit direction.
    Vec3d outermost(const Vec3d& origin, const Vec3d& direction) const;
    /// The surface point near x down the gradient.
    Vec3d project(Vec3d x) const;

private:
    enum class Kind { ellipsoid, round_cone, floor };
    struct Part {
        Kind kind;
        Vec3d a, b;  ///< ellipsoid: centre and radii; round cone: the balls' centres; floor: a.z is the height
        double ra = 0, rb = 0;
        double blend = 0;
        bool carve = false;
    };
    std::vector<Part> parts_;
    std::vector<Vec3d> tips_;

    static double distance(const Part& part, const Vec3d& x);
};

/// Twelve soft arms around a ball. The seed turns it and varies the arms a little.
Solid star_solid(uint64_t seed);
/// Head, neck and shoulders, facing -y, cut flat below. The seed varies the proportions a little.
/// detail: about the least radius that its mesh can carry; the nose is made no thinner.
Solid bust_solid(uint64_t seed, double detail);
/// A ball to hang up: a collar with a knob above, a drop below. Turned, so it is the same from all sides.
Solid ornament_solid();

}  // namespace radiafit
