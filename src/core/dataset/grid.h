#pragma once
#include <string>
#include <vector>

#include "geometry/atlas.h"
#include "geometry/camera.h"

namespace radiafit {

/// A flat grid of texels in place of a mesh: every image of the dataset has one pixel per texel, at the same place.
/// A flat sample whose photographs were rectified, or what a camera that does not move sees of an object.
struct Grid {
    int width = 0, height = 0;         ///< texels; 0: there is none, the dataset has a mesh
    Vec3d origin = Vec3d::Zero();      ///< world space: centre of the top left texel
    Vec3d right = Vec3d::UnitX();      ///< world space: step from a texel to the next in its row
    Vec3d down = -Vec3d::UnitY();      ///< to the next in its column; at right angles to `right`
    std::vector<Vec3f> texel_normals;  ///< [height][width] unit, 0 where a texel isn't fitted; empty: `normal()` in all

    size_t texel_count() const { return size_t(width) * size_t(height); }
    Vec3d position(int column, int row) const { return origin + column * right + row * down; }
    Vec3d normal() const;  ///< of the plane, towards the cameras

    /// Centred on the world's origin in the plane z = 0: x right, y up, z towards the cameras. `texel`: a texel's side.
    static Grid centered(int width, int height, double texel);
    /// The pinhole camera at `eye` that sees every texel's centre at its pixel's centre: what a rectified photograph
    /// is. Throws UserError, prefixed by `name`, for an eye in the grid's plane or behind it.
    Camera camera_at(const Vec3d& eye, const std::string& name) const;
};

/// Throws UserError, prefixed by `name`, unless every number is finite, the steps are at right angles (1e-6) and every
/// normal is 0 or of unit length to 1e-4.
void check_grid(const Grid& grid, const std::string& name);

GridAtlas make_atlas(const Grid& grid);

}  // namespace radiafit
