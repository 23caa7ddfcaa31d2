#include "synthetic/shading/reflectance.h"

#include <cmath>

#include "model/texel_texts.h"
#include "synthetic/shading/blinn.h"
#include "synthetic/shading/oren_nayar.h"

namespace radiafit {
namespace {

/// One weight for each of the three colours of two coefficients.
Vec3d mix(const TexelParameters& p, double first, double second) {
    return {double(p[0]) * first + double(p[3]) * second, double(p[1]) * first + double(p[4]) * second,
            double(p[2]) * first + double(p[5]) * second};
}

}  // namespace

Vec3d reflect(ReflectanceModel model, const TexelParameters& p, const Angles& angles) {
    if (!(angles.u_z > 0)) return Vec3d::Zero();
    if (model == ReflectanceModel::oren_nayar_blinn)
        return mix(p, oren_nayar(double(p[6]), angles), blinn(double(p[8]), angles));
    using Text = texel_text::lafortune<double>;
    const Text::Terms terms = {{angles.across(), angles.u_z * angles.v_z, angles.u_z}};  // sample_terms() of u and v
    const Text::Shape shape = {{double(p[6]), double(p[7]), std::log(double(p[8]))}};
    const Text::Basis basis = Text::basis(shape, terms);
    return mix(p, basis.x[0], basis.x[1]);
}

TruthMaterial describe(const std::string& material, ReflectanceModel model) {
    if (model == ReflectanceModel::oren_nayar_blinn)
        return {
            material,
            "oren-nayar-blinn",
            {"albedo.R", "albedo.G", "albedo.B", "specular.R", "specular.G", "specular.B", "sigma", "", "exponent"}};
    return {material, "lafortune", {"rho_d.R", "rho_d.G", "rho_d.B", "rho_s.R", "rho_s.G", "rho_s.B", "Cx", "Cz", "n"}};
}

}  // namespace radiafit
