#include "dataset/grid.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/error.h"

namespace radiafit {

Vec3d Grid::normal() const { return down.cross(right).normalized(); }

Grid Grid::centered(int width, int height, double texel) {
    Grid grid;
    grid.width = width;
    grid.height = height;
    grid.origin = Vec3d(0.5 * (1 - width) * texel, 0.5 * (height - 1) * texel, 0);
    grid.right = Vec3d(texel, 0, 0);
    grid.down = Vec3d(0, -texel, 0);
    return grid;
}

Camera Grid::camera_at(const Vec3d& eye, const std::string& name) const {
    const double depth = normal().dot(eye - origin);
    if (!(depth > 0))
        throw UserError(
            fmt::format("{}: the camera at ({:g}, {:g}, {:g}) doesn't stand in front of the sample; give z "
                        "above 0, towards the camera",
                        name, eye.x(), eye.y(), eye.z()));
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.cam_from_world_rotation.row(0) = right.normalized();
    camera.cam_from_world_rotation.row(1) = down.normalized();
    camera.cam_from_world_rotation.row(2) = -normal();
    camera.cam_from_world_translation = -camera.cam_from_world_rotation * eye;
    const Vec3d corner = camera.to_camera(origin);
    camera.fx = depth / right.norm();
    camera.fy = depth / down.norm();
    camera.cx = 0.5 - corner.x() / right.norm();
    camera.cy = 0.5 - corner.y() / down.norm();
    return camera;
}

void check_grid(const Grid& grid, const std::string& name) {
    if (!grid.origin.allFinite() || !grid.right.allFinite() || !grid.down.allFinite())
        throw UserError(fmt::format("{}: the grid holds a number that is not finite; calibrate it again", name));
    const double area = grid.right.norm() * grid.down.norm();
    if (!(area > 0) || std::abs(grid.right.dot(grid.down)) > 1e-6 * area)
        throw UserError(
            fmt::format("{}: the grid's steps right and down must be at right angles and longer than 0", name));
    for (size_t i = 0; i < grid.texel_normals.size(); ++i) {
        const Vec3f& n = grid.texel_normals[i];
        if (n != Vec3f::Zero() && !(std::abs(n.norm() - 1) < 1e-4f))  // not a number either
            throw UserError(fmt::format("{}: normal {} is ({}, {}, {}), neither 0 nor of unit length; normalize it",
                                        name, i, n.x(), n.y(), n.z()));
    }
}

GridAtlas make_atlas(const Grid& grid) {
    const size_t count = grid.texel_count();
    std::vector<Vec3f> positions, normals = grid.texel_normals;
    std::vector<uint8_t> usable;
    positions.reserve(count);
    for (int row = 0; row < grid.height; ++row)
        for (int column = 0; column < grid.width; ++column)
            positions.push_back(grid.position(column, row).cast<float>());
    const Vec3f plane = grid.normal().cast<float>();
    if (normals.empty()) {
        normals.assign(count, plane);
    } else {
        usable.reserve(count);
        for (Vec3f& n : normals) {
            usable.push_back(n != Vec3f::Zero());
            if (!usable.back()) n = plane;  // an atlas has unit normals everywhere
        }
    }
    return {grid.width, grid.height, std::move(positions), std::move(normals), std::move(usable)};
}

}  // namespace radiafit
