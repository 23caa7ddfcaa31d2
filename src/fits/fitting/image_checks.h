#pragma once
#include <string>
#include <vector>

#include "base/rings.h"
#include "dataset/dataset.h"

/// What small fits say of a dataset's images, before anything is fitted in earnest.
namespace radiafit::fits {

/// Training images that the simplest model, a mean colour per texel of a coarse lattice over the mesh, where lamps move
/// a Lambertian fit, misses by far more than the others (eval/outliers.h). None where it cannot be fitted, takes
/// more than half of the free memory, or has too few images to say so.
std::vector<std::string> suspicious_images(const Dataset& dataset);
/// One line for people that names them and the cure; empty if there are none.
std::string describe_suspicious(const std::vector<std::string>& names);

}  // namespace radiafit::fits
