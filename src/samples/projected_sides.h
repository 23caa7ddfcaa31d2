#pragma once
#include <span>
#include <vector>

#include "dataset/dataset.h"
#include "geometry/atlas.h"

/// Sides of surface maps by the size of their triangles in photographs: texels where there are pixels (Section 6.3).
namespace radiafit {

/// [triangles] Area in pixels of a triangle's largest projection into those of `views` in which a pixel shows it; 0
/// where none does.
std::vector<double> projected_areas(const Dataset& dataset, const std::vector<uint32_t>& views);

/// [triangles] The least side with so many texels per pixel of the area, within [least_side, most].
TileSides sides_by_area(std::span<const double> areas, double texels_per_pixel, int most);
int largest_of(const TileSides& sides);

/// The texels per pixel with which triangles that are seen have so many texels on average, or as near as whole sides
/// come.
double density_for(std::span<const double> areas, double mean_texels, int most);

}  // namespace radiafit
