#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "capture/calibration.h"
#include "geometry/mesh.h"

/// Masks of photographs: those that a user has, and those that a mesh makes.
namespace radiafit::tools {

/// The mask of each image of the model (capture/mask_names.h); empty if `masks` is. Throws UserError.
std::vector<std::filesystem::path> find_mask_files(const Calibration& model, const std::filesystem::path& images,
                                                   const std::filesystem::path& masks);
/// The mask of image i, [height][width], 255 = object; empty where there are no files. Throws UserError for another
/// size than the camera's.
std::vector<uint8_t> load_mask(const std::vector<std::filesystem::path>& files, size_t i, const Camera& camera);

/// Writes what each camera sees of the mesh, less a rim of `inset` pixels, as out/NAME.png; the folder is written
/// atomically. Throws UserError, also for two images whose names differ in the ending alone.
void write_mesh_masks(const Mesh& mesh, const Calibration& model, int inset, const std::filesystem::path& out);

}  // namespace radiafit::tools
