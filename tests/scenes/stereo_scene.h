#pragma once
#include <cmath>
#include <vector>

#include "base/rng.h"
#include "capture/colmap_points.h"
#include "geometry/camera.h"
#include "geometry/mesh.h"
#include "stereo/grey_image.h"
#include "stereo/plane_map.h"

/// A textured unit sphere before nothing, and cameras that look at it: depths are known in closed form.
namespace radiafit::testing {
using namespace tools;

/// Smooth noise in space, the same from wherever it is seen; octaves down to about two pixels of the images below.
inline float texture_at(const Vec3d& p) {
    const auto lattice = [](int64_t x, int64_t y, int64_t z) {
        return random_uniform(7, uint64_t(x * 73856093) ^ uint64_t(y * 19349663) ^ uint64_t(z * 83492791));
    };
    double value = 0;
    for (const double scale : {6.0, 12.0, 24.0}) {
        const Vec3d q = p * scale + Vec3d::Constant(100);
        const Eigen::Array3d low = q.array().floor(), f = q.array() - low;
        for (int corner = 0; corner < 8; ++corner) {
            const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
            const double weight = (dx ? f.x() : 1 - f.x()) * (dy ? f.y() : 1 - f.y()) * (dz ? f.z() : 1 - f.z());
            value += weight * double(lattice(int64_t(low.x()) + dx, int64_t(low.y()) + dy, int64_t(low.z()) + dz)) / 3;
        }
    }
    return float(value);
}

/// On a circle at distance 5, `step` degrees apart, looking at the centre; sides of `size` pixels that the sphere
/// nearly fills.
inline std::vector<Camera> cameras_around(int count, double step, int size) {
    std::vector<Camera> cameras;
    for (int i = 0; i < count; ++i) {
        const double angle = (i - (count - 1) / 2.0) * step * 3.14159265358979 / 180;
        cameras.push_back(Camera::look_at({5 * std::sin(angle), 0.3 * (i % 2), 5 * std::cos(angle)}, Vec3d::Zero(),
                                          Vec3d::UnitY(), 0.48, size, size));
    }
    return cameras;
}

/// z of the unit sphere in the direction of a pixel of depth 1; 0 where it is missed.
inline double sphere_depth(const Camera& camera, const Vec3d& ray) {
    const Vec3d c = camera.to_camera(Vec3d::Zero());
    const double a = ray.squaredNorm(), b = ray.dot(c), root = b * b - a * (c.squaredNorm() - 1);
    return root < 0 ? 0 : (b - std::sqrt(root)) / a;
}

inline Vec3d world_of(const Camera& camera, const Vec3d& in_camera) {
    return camera.cam_from_world_rotation.transpose() * (in_camera - camera.cam_from_world_translation);
}

inline GreyImage photograph_of_sphere(const Camera& camera) {
    GreyImage image{camera, {}};
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            const Vec3d ray((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
            const double z = sphere_depth(camera, ray);
            image.values.push_back(z > 0 ? 0.1f + 0.8f * texture_at(world_of(camera, z * ray)) : 0);
        }
    return image;
}

/// The true planes, zero off the sphere.
inline PlaneMap planes_of_sphere(const Camera& camera) {
    PlaneMap map{camera, {}};
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            const Vec3d ray((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
            const double z = sphere_depth(camera, ray);
            if (z == 0) {
                map.planes.push_back(InversePlane::Zero());
                continue;
            }
            const Vec3d normal = camera.cam_from_world_rotation * world_of(camera, z * ray);
            map.planes.push_back(make_plane(ray.cast<float>(), float(1 / z), normal.normalized().cast<float>()));
        }
    return map;
}

/// Rings and segments of a sphere around `centre`.
inline Mesh sphere_mesh(const Vec3d& centre, double radius, int rings, int segments) {
    Mesh mesh;
    const double pi = 3.14159265358979;
    for (int r = 0; r <= rings; ++r)
        for (int s = 0; s < segments; ++s) {
            const double polar = pi * r / rings, around = 2 * pi * s / segments;
            mesh.positions.push_back((centre + radius * Vec3d(std::sin(polar) * std::cos(around), std::cos(polar),
                                                              -std::sin(polar) * std::sin(around)))
                                         .cast<float>());
        }
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < segments; ++s) {
            const auto at = [&](int ring, int segment) { return uint32_t(ring * segments + segment % segments); };
            if (r > 0) mesh.triangles.push_back({at(r, s), at(r + 1, s), at(r, s + 1)});
            if (r + 1 < rings) mesh.triangles.push_back({at(r, s + 1), at(r + 1, s), at(r + 1, s + 1)});
        }
    return mesh;
}

}  // namespace radiafit::testing
