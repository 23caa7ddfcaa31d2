#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "dataset/dataset.h"

/// What a synthetic dataset was made of, beside it: the reflectance of every texel. Three files in the dataset's
/// folder, field by field in docs/formats.md.
namespace radiafit {

inline constexpr const char* truth_json_name = "truth.json";
inline constexpr const char* truth_parameters_name = "truth_parameters.f32";
inline constexpr const char* truth_material_name = "truth_material.u8";

struct TruthMaterial {
    std::string name;                     ///< "gold"
    std::string model;                    ///< "lafortune" or "oren-nayar-blinn"
    std::vector<std::string> parameters;  ///< what the nine numbers of a texel mean; "" for one that means nothing
};

struct ReflectanceTruth {
    int side = 0;  ///< of the triangle atlas
    /// Whether a pixel holds the very value of the texel that takes it, up to noise and quantization (else it averages
    /// over its area).
    bool exact = false;
    std::vector<TruthMaterial> materials;
    std::vector<uint8_t> material;                 ///< [texels] index into materials
    std::vector<std::array<float, 9>> parameters;  ///< [texels]
};

/// `folder`: the dataset's, or its writer's temporary one. Throws UserError where it cannot write.
void write_truth(const ReflectanceTruth& truth, const std::filesystem::path& folder);
/// Whether a truth belongs to the dataset, even one that is missing by now.
bool has_truth(const Dataset& dataset);
/// Throws UserError that names file and cure: missing, of another size, damaged.
ReflectanceTruth read_truth(const std::filesystem::path& folder);

}  // namespace radiafit
