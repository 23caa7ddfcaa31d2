#pragma once
#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "geometry/light.h"

namespace radiafit {

/// One white lamp per camera of an object around the origin, on the camera's side: directions within `widest` degrees
/// of the camera's, spread evenly in solid angle. Each gives a white diffuse surface that faces it radiance 1 at most,
/// anywhere within `radius` of the origin: distant lamps exactly 1.
std::vector<Light> moving_lights(const std::vector<Camera>& cameras, Light::Kind kind, double radius, uint64_t seed);

inline constexpr double widest_light = 75;  ///< degrees between light and camera

}  // namespace radiafit
