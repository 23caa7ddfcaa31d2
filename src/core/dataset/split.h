#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/linear.h"

namespace radiafit {

/// Which of the images are held out:
///     none
///     every:N        the first of each N, in their order; every:N+K begins K images later, K below N
///     random:N       N of them; random:N:SEED by another seed than 1
///     spread:N       N of them, spread over their directions, each amid others (geometry/direction_hull.h)
///     FILE           those that it names, one per line (# comments)
/// directions: unit, of the lamps where they move, else of the cameras; one per image. Throws UserError for another
/// rule, a name that is not among the images, and a rule that leaves nothing to fit.
std::vector<uint8_t> choose_held_out(const std::vector<std::string>& names, std::span<const Vec3d> directions,
                                     const std::string& rule);

}  // namespace radiafit
