#pragma once
#include <span>
#include <vector>

#include "dataset/dataset.h"

/// Whether what is held out lies amid what is fitted, or beyond it.
namespace radiafit {

/// The centre of the mesh's bounding box, or of the grid.
Vec3d surface_centre(const Mesh& mesh, const Grid& grid);

/// For each view: by how far (radians) its camera's or its lamp's direction from `centre`, whichever is farther, lies
/// outside the cone that those of the training views span; 0 for training views, and inside. Only lamps and cameras
/// that differ between views say anything.
std::vector<double> angles_outside(const Vec3d& centre, std::span<const View> views);

/// From here on (radians: one degree) a view counts as outside.
inline constexpr double least_outside = 0.017453292519943295;

/// "12 of 12 held-out views lie up to 9 degrees outside ...": empty if none lies outside by a degree or more.
std::string outside_note(std::span<const View> views, std::span<const double> angles);

}  // namespace radiafit
