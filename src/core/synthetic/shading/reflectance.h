#pragma once
#include <array>
#include <string>

#include "dataset/truth.h"
#include "synthetic/shading/angles.h"

/// The reflectance of a texel by its nine numbers: two models, three materials.
namespace radiafit {

using TexelParameters = std::array<float, 9>;

enum class ReflectanceModel {
    oren_nayar_blinn,  ///< albedo (3), specular (3), sigma, unused, exponent
    lafortune          ///< rho_d (3), rho_s (3), Cx, Cz, n: Eq. 16, gauge max(|Cx|, |Cz|) = 1
};

/// Radiance (linear RGB) under a light that gives a white diffuse surface facing it radiance 1; 0 unless u_z > 0.
Vec3d reflect(ReflectanceModel model, const TexelParameters& p, const Angles& angles);

/// As truth.json describes it.
TruthMaterial describe(const std::string& material, ReflectanceModel model);

}  // namespace radiafit
