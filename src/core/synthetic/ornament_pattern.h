#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/linear.h"
#include "synthetic/shading/reflectance.h"

namespace radiafit {

enum class OrnamentMaterial : uint8_t { white, gold, green };
inline constexpr std::array<const char*, 3> ornament_material_names = {"white", "gold", "green"};
constexpr ReflectanceModel model_of(OrnamentMaterial m) {
    return m == OrnamentMaterial::white ? ReflectanceModel::oren_nayar_blinn : ReflectanceModel::lafortune;
}

/// The decoration of the ornament, a function of space: white ground, green leaves with gilt rims, gold rosettes, rope
/// mouldings and caps, all in relief, worn and polished unevenly. The seed turns it and places the wear.
class OrnamentPattern {
public:
    explicit OrnamentPattern(uint64_t seed);

    struct Point {
        OrnamentMaterial material = OrnamentMaterial::white;
        double height = 0;  ///< of the relief over the mesh, world units
        double shade = 0;   ///< 0 to 1: from a leaf's rib to its rim
    };
    Point at(const Vec3d& x) const;

    /// The unit normal of the relief on a surface with unit normal `normal`; details below `step` are smoothed.
    Vec3d normal(const Vec3d& x, const Vec3d& normal, double step) const;
    /// Lafortune's nine in the canonical gauge, or white's.
    TexelParameters parameters(const Vec3d& x) const;

private:
    /// A sum of waves, smooth, 0 to 1.
    struct Noise {
        std::vector<Vec3d> waves;
        std::vector<double> phases;
        double operator()(const Vec3d& x) const;
    };
    Noise make_noise(uint64_t seed, uint64_t stream, double frequency) const;
    Point frieze(double longitude, double latitude) const;
    Point leaves(double longitude, double above) const;
    Point cap(const Vec3d& x, double longitude, double above) const;

    double turn_;  ///< radians
    std::array<Noise, 4> wear_;
};

}  // namespace radiafit
