#pragma once
#include <array>
#include <vector>

#include "capture/rti_file.h"

/// The functions of the lamp's direction that files of RTI are sums of.
namespace radiafit::tools {

/// x^2, y^2, x y, x, y, 1.
std::array<double, 6> ptm_functions(const Vec3d& lamp);

/// Hemispherical harmonics as RTIBuilder and relight have them: 4, 9 or 16 of them. Of degree l they are those from
/// l^2 on: cosines of l to 1 times the azimuth, the zonal one, sines of 1 to l times; of twice the azimuth with the
/// sign turned.
std::vector<double> hsh_functions(const Vec3d& lamp, size_t count);
/// "hsh3" for 9 of them; null for another count than 4, 9 and 16.
const TexelModel* hsh_model(size_t count);

/// [3][1 + 3 count]: number 3 k + c multiplies function k in channel c.
LampMatrix in_each_channel(std::span<const double> functions);

}  // namespace radiafit::tools
