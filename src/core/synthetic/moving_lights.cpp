#include "synthetic/moving_lights.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "base/rng.h"

namespace radiafit {

std::vector<Light> moving_lights(const std::vector<Camera>& cameras, Light::Kind kind, double radius, uint64_t seed) {
    constexpr double near_distance = 4;  // from the origin, in world units
    const double least_cosine = std::cos(widest_light * std::numbers::pi / 180);
    Rng rng(seed, 10);
    const double start = rng.uniform(), turned = rng.uniform();
    const auto fraction = [](double x) { return x - std::floor(x); };
    std::vector<Light> lights;
    for (size_t i = 0; i < cameras.size(); ++i) {
        // Roberts' low-discrepancy sequence in two dimensions.
        const double cosine = 1 - (1 - least_cosine) * fraction(start + 0.7548776662466927 * double(i + 1));
        const double angle = 2 * std::numbers::pi * fraction(turned + 0.5698402909980532 * double(i + 1));
        const double sine = std::sqrt(1 - cosine * cosine);
        const Vec3d axis = cameras[i].center().normalized(), right = cameras[i].cam_from_world_rotation.row(0);
        const Vec3d x = (right - right.dot(axis) * axis).normalized(), y = axis.cross(x);
        const Vec3d direction = (cosine * axis + sine * (std::cos(angle) * x + std::sin(angle) * y)).normalized();
        Light light;
        light.kind = kind;
        if (kind == Light::Kind::near) {
            light.place = near_distance * direction;
            light.intensity = Vec3d::Constant((near_distance - radius) * (near_distance - radius));
        } else {
            light.place = direction;
        }
        lights.push_back(light);
    }
    return lights;
}

}  // namespace radiafit
