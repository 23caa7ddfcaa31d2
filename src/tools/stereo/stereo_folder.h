#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "capture/calibration.h"
#include "stereo/plane_map.h"

/// Depth and normal maps in the folder `stereo` of a COLMAP workspace, as `colmap patch_match_stereo` writes and
/// `colmap stereo_fusion` reads them: depth_maps/NAME.geometric.bin and normal_maps/NAME.geometric.bin, each the text
/// "WIDTH&HEIGHT&CHANNELS&" and floats, little-endian [channels][height][width], depths z, normals in the camera's
/// coordinates and facing it, 0 where nothing is known; and fusion.cfg, which names the photographs. For them, as for
/// COLMAP's fusion, the pixel in column x and row y is at (x, y) of the calibration, not at (x + 0.5, y + 0.5).
namespace radiafit::tools {

/// Writes both maps of one photograph; `name` is its name in the model, which may have subfolders.
void write_planes(const std::filesystem::path& stereo, const std::string& name, const PlaneMap& map);
/// Writes what stereo_fusion wants beside the maps.
void write_fusion_list(const std::filesystem::path& stereo, const std::vector<std::string>& names);

/// Reads both maps. Throws UserError that names the file: missing, malformed, cut, of another size than the camera, a
/// depth that is negative or not finite, a normal that does not face the camera.
PlaneMap read_planes(const std::filesystem::path& stereo, const std::string& name, const Camera& camera);
/// Those of all photographs of a model.
std::vector<PlaneMap> read_planes(const std::filesystem::path& stereo, const Calibration& model);

}  // namespace radiafit::tools
