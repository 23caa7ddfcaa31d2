#pragma once
#include <string>

#include "base/linear.h"

/// What check_light() asks of a light's numbers, for readers that know the line of each. Throw UserError,
/// prefixed by `name`.
namespace radiafit {

/// Throws unless every channel is 0 or from 1e-12 to 1e12, and not all are 0.
void check_intensity(const Vec3d& intensity, const std::string& name);
/// Throws unless the length is from 1e-12 to 1e12: of a place, or of a vector of which only the direction is taken.
void check_light_vector(const Vec3d& vector, const std::string& name);

}  // namespace radiafit
