#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "fit/fit_folder.h"
#include "fit/texel_fit.h"
#include "geometry/atlas.h"

/// fit.json as text: everything of a fit that is no map.
namespace radiafit {

inline constexpr const char* fit_format = "radiafit-fit";
inline constexpr int fit_version = 1,
                     newer_version = 2;  ///< the latter where surface maps differ in side, or on a curve
inline constexpr const char* fit_json_name = "fit.json";

/// `dataset_path` is what is saved: relative to the fit folder. `files`: the names in the folder. Throws
/// std::invalid_argument if one of the fit's JSON texts is none.
std::string fit_to_json(const LightFieldFit& fit, const TriangleAtlas& atlas, const std::string& dataset_path,
                        const std::vector<std::string>& files);
/// The files of the folder that a fit.json lists; empty if the text is no fit.json.
std::vector<std::string> files_in_json(const std::string& text);

/// A reflectance fit's notes, and back: what take_notes() throws, fit_from_json() reports as a fault of the file.
inline constexpr const char* reflectance_key = "reflectance";
TexelFitNotes notes_of(const ReflectanceFit& fit);
void take_notes(const std::string& model, const std::string& own_json, ReflectanceFit& fit);

/// fit_to_json() for a model in texels.
std::string fit_to_json(const FitRecord& fit, const TexelFitNotes& notes, const Atlas& atlas,
                        const std::string& dataset_path, const std::vector<std::string>& files);
/// The checksum of surface maps' sides, as fit.json has it.
std::string checksum_of(const std::vector<uint8_t>& sides);
/// "lfm" or a texel-local model's name. Throws UserError.
std::string model_in_json(const std::filesystem::path& path, const std::string& text);

/// What fit.json promises about the images beside it.
struct FitPromises {
    std::string dataset_path;
    std::array<uint64_t, size_t(Status::count)> status_counts{};
    std::string sides;  ///< checksum of surface maps' sides, which are in an image; empty: they have one
};

/// Fills everything but the parameters and the problems' figures. `path` is what messages name; throws UserError.
FitPromises fit_from_json(const std::filesystem::path& path, const std::string& text, LightFieldFit& fit);
/// take(model, own_json): TexelFitNotes of this key. What it throws is reported as a fault of the file.
FitPromises fit_from_json(const std::filesystem::path& path, const std::string& text, const std::string& key,
                          const TakeNotes& take, FitRecord& fit);

}  // namespace radiafit
