#pragma once
#include <string>

#include "base/linear.h"

namespace radiafit {

/// The one lamp that lights an image. Its light has no size: a surface point sees it from one direction. What a
/// reflectance model calls 1 is a white diffuse surface that faces the lamp, so a pixel is irradiance * model.
struct Light {
    enum class Kind {
        distant,  ///< the same direction and intensity everywhere
        near      ///< at a point; falls off with the square of the distance
    };
    Kind kind = Kind::distant;
    Vec3d place = Vec3d::UnitZ();     ///< world space. distant: unit direction towards the lamp; near: where it is
    Vec3d intensity = Vec3d::Ones();  ///< linear RGB. near: at distance 1, in world units

    /// Unit direction from x to the lamp.
    Vec3d direction_from(const Vec3d& x) const {
        return kind == Kind::distant ? place : Vec3d((place - x).normalized());
    }
    /// Linear RGB of a white diffuse surface at x that faces the lamp.
    Vec3d irradiance_at(const Vec3d& x) const {
        return kind == Kind::distant ? intensity : Vec3d(intensity / (place - x).squaredNorm());
    }
};

/// Throws UserError, prefixed by `name`, unless every number is finite, a direction is of unit length to 1e-4 and the
/// intensity is not below 0 nor all black.
void check_light(const Light& light, const std::string& name);

}  // namespace radiafit
