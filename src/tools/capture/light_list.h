#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "capture/import_lights.h"
#include "geometry/light.h"

/// What lists say of images under lamps: which images, in which order, and how each is lit.
namespace radiafit::tools {

/// The images in their order.
struct NamedImages {
    std::vector<std::string> names;  ///< as listed
    std::vector<std::filesystem::path> files;
    std::vector<Vec3d> vectors;  ///< of the lights' file, which each image has one of; empty: there is no such file
};

/// Of the folder, or the names' or the light file's list; throws UserError where these don't agree.
NamedImages list_named(const LightImportOptions& options, LightImportReport& report);

/// Light::intensity of each of so many images; empty: not given.
std::vector<Vec3d> given_intensities(const LightImportOptions& options, size_t images, LightImportReport& report);

/// As the lights' file has them. intensities: empty, all 1.
std::vector<Light> given_lights(const LightImportOptions& options, const NamedImages& images,
                                const std::vector<Vec3d>& intensities);

/// Entry i of a list that has one entry per image or one for all.
inline const Vec3d& entry_for(const std::vector<Vec3d>& list, size_t i) { return list.size() == 1 ? list[0] : list[i]; }

/// Throws UserError, naming the list's `file` and what it lists, unless entry_for() has one for each of the images.
void expect_entries(const std::filesystem::path& file, const char* what, size_t entries, size_t images,
                    LightImportReport& report);

}  // namespace radiafit::tools
