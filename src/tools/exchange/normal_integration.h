#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/linear.h"

/// Heights from normals (normal integration): by weighted least squares, which comes to a Poisson equation on the part
/// of a grid that a surface covers, with the natural (Neumann) boundary condition at its edge.
namespace radiafit::tools {

struct HeightMap {
    std::vector<float> heights;  ///< [height][width] in the unit of `step`, up out of the plane; 0 where no surface is
    int parts = 0;               ///< connected pieces of surface; each has a mean of 0, as nothing says how they stand
};

/// The surface z whose slopes are nearest to those of the normals, p = -n_x / n_z right and q = -n_y / n_z up, seen
/// from far above (orthographic). Between neighbours a and b of a row or a column the slope is the mean of both
/// (Horn & Brooks, CVGIP 1986), and
///     sum over pairs of n_z(a) n_z(b) (z_b - z_a - step * slope)²
/// is least: n_z makes it the distance to the neighbours' tangent planes, so that steep texels, whose slopes are the
/// least certain, count least (Quéau, Durou and Aujol, Normal Integration: A Survey, JMIV 2018). n_z counts as 0.05 at
/// least, 87 degrees. Solved by conjugate gradients, preconditioned by a multigrid V-cycle over the grid's halves,
/// until the error's energy norm is 1e-7 of what it was.
///
/// normals: [height][width] unit, x right, y up, z out of the plane; 0: unknown. Surface of unknown normals is spanned
/// as a membrane between its neighbours.
/// surface: [height][width] non-zero where a surface is; empty: everywhere.
/// step: world units, or pixels, from a texel to the next in its row, and in its column.
/// Throws UserError for other numbers of texels than width x height, steps that aren't above 0, and a normal that isn't
/// finite.
HeightMap integrate_normals(int width, int height, std::span<const Vec3f> normals, std::span<const uint8_t> surface,
                            const std::array<double, 2>& step);

}  // namespace radiafit::tools
