#include "synthetic/viewpoints.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/rng.h"

namespace radiafit {
namespace {

constexpr double field_of_view = 26 * std::numbers::pi / 180;  // a short telephoto lens
constexpr double filled = 0.995;                               // of the frame's side, by the mesh's longer extent
constexpr double lowest = 0.05, highest = 0.995;               // z of the viewing direction: not quite rim and pole
constexpr double sway = 0.35;                                  // of the spacing of views

/// Turns and steps back until the mesh's image is in the middle and fills the frame.
Camera framed(const Mesh& mesh, const Vec3d& direction, int side) {
    Vec3d target = Vec3d::Zero();
    double distance = 5;
    Camera camera;
    for (int round = 0; round < 6; ++round) {  // each round leaves a small share of the last one's offset
        camera = Camera::look_at(target + distance * direction, target, Vec3d::UnitZ(), field_of_view, side, side);
        Vec2d low(1e9, 1e9), high(-1e9, -1e9);
        for (const Vec3f& p : mesh.positions) {
            const Vec2d pixel = camera.project(p.cast<double>()).head<2>();
            low = low.cwiseMin(pixel);
            high = high.cwiseMax(pixel);
        }
        const Vec2d offset = 0.5 * (low + high) - Vec2d(camera.cx, camera.cy);
        target += camera.cam_from_world_rotation.transpose() *
                  Vec3d(offset.x() * distance / camera.fx, offset.y() * distance / camera.fy, 0);
        distance *= (high - low).maxCoeff() / (filled * side);
    }
    return camera;
}

/// Cameras over the zone of directions with z in [low, high].
std::vector<Camera> zone_cameras(const Mesh& mesh, int count, int side, uint64_t seed, double low, double high,
                                 double solid_angle) {
    Rng rng(seed, 2);
    const double spacing = std::sqrt(solid_angle / count);  // radians between neighbours, about
    const double start = 2 * std::numbers::pi * rng.uniform();
    std::vector<Vec3d> directions;
    for (int i = 0; i < count; ++i) {
        const double share = (i + 0.5 + sway * double(rng.uniform(-1, 1))) / count;
        const double z = low + (high - low) * share, radius = std::sqrt(1 - z * z);
        const double turn = start + std::numbers::pi * (3 - std::sqrt(5.0)) * i +
                            sway * spacing * double(rng.uniform(-1, 1)) / std::max(radius, 0.2);
        directions.emplace_back(radius * std::cos(turn), radius * std::sin(turn), z);
    }
    for (size_t i = directions.size(); i > 1; --i) std::swap(directions[i - 1], directions[rng.index(uint32_t(i))]);

    std::vector<Camera> cameras;
    for (const Vec3d& direction : directions) cameras.push_back(framed(mesh, direction, side));
    return cameras;
}

}  // namespace

std::vector<Camera> hemisphere_cameras(const Mesh& mesh, int count, int side, uint64_t seed) {
    return zone_cameras(mesh, count, side, seed, lowest, highest, 2 * std::numbers::pi);
}

std::vector<Camera> sphere_cameras(const Mesh& mesh, int count, int side, uint64_t seed) {
    return zone_cameras(mesh, count, side, seed, -highest, highest, 4 * std::numbers::pi);
}

}  // namespace radiafit
