#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/linear.h"
#include "model/texel_model.h"
#include "model/value_curve.h"

/// Images under lamps that move, as other programs store them: polynomial texture maps (.ptm), hemispherical harmonics
/// (.rti), and what relight writes (info.json).
namespace radiafit::tools {

/// [channel][1 + numbers]
using LampMatrix = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// In each pixel and channel a sum of functions of the lamp's direction. Lamps are distant and of intensity 1; the sum
/// is the light, on a curve, 1 being white.
struct RtiFile {
    std::string kind;                     ///< a few words, such as "PTM_FORMAT_LRGB"
    ValueCurve curve = ValueCurve::srgb;  ///< where a file does not say: what the pictures stored that it was made of
    int width = 0, height = 0;            ///< pixels
    size_t numbers = 0;                   ///< of each pixel
    std::vector<float> values;            ///< [height][width][numbers], row 0 on top
    /// At the unit direction to a lamp (x right, y up, z towards the camera), z above 0: what is shown of no number
    /// (column 0), and what each number is multiplied by.
    std::function<LampMatrix(const Vec3d& lamp)> functions;
    /// The texel-local model whose functions make up these, values then being [functions][channel]; null: there is
    /// none.
    const TexelModel* model = nullptr;
};

/// Called once the sizes are known, before memory is taken for values: the place to refuse what is too large.
using RtiSizeCheck = std::function<void(int width, int height, size_t numbers)>;

/// Told apart by content: a .ptm of version 1.1 or 1.2 (Malzbender and Gelb 2001), an .rti of hemispherical harmonics,
/// or an info.json of relight or the folder that holds one. Throws UserError that names file and cure: missing, another
/// format, a kind that isn't read, truncated, sizes and numbers that can't be.
RtiFile read_rti(const std::filesystem::path& file, const RtiSizeCheck& check = {});

}  // namespace radiafit::tools
