#pragma once
#include <span>
#include <vector>

#include "dataset/dataset.h"
#include "geometry/atlas.h"

/// Sides of surface maps by the size of their triangles in photographs: texels where there are pixels (Section 6.3).
namespace radiafit {

/// [triangles] Area in pixels of a triangle's largest projection into those of `views` in which a pixel shows it,
/// masked or not, and no more than such an image has; 0 where none does.
std::vector<double> projected_areas(const Dataset& dataset, const std::vector<uint32_t>& views);

/// [triangles] The least side with so many texels per pixel of the area, within [least_side, largest_side].
TileSides sides_by_area(std::span<const double> areas, double texels_per_pixel);
int largest_of(const TileSides& sides);

/// Texels per pixel, to four digits and at most `limit`, with which triangles have so many texels on average, or about
/// so many: sides are whole.
double density_for(std::span<const double> areas, double mean_texels, double limit);

}  // namespace radiafit
