#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "report/csv.h"

namespace radiafit::harness {

/// The shares of the problems at which solvers are compared.
inline constexpr std::array rival_shares = {0.5, 0.9, 0.99};

/// What a solver needs for each problem until so many of them have arrived.
struct Rival {
    std::string solver, precision, instructions;
    int together = 1;                                                     ///< problems in a register
    std::array<std::optional<double>, rival_shares.size()> seconds = {};  ///< none: so many never arrive
    double arrived = 0;                                                   ///< share of those that do
    size_t problems = 0;                                                  ///< that it was given
};

/// Of light field maps, whose problem here is a vertex with its three channels: the processor time that each vertex is
/// given, by rows of `solvers`. Of Ceres' settings the best one; whoever had time for few vertices is left out. The
/// quickest at nine in ten problems comes first.
std::vector<Rival> vertex_rivals(const CsvTable& vertices, const CsvTable& solvers);

/// Of texels with Lafortune's model: the time of fits of so many iterations, over the texels, by rows of `reflectance`.
std::vector<Rival> texel_rivals(const CsvTable& arrival);

}  // namespace radiafit::harness
