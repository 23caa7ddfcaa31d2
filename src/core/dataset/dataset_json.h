#pragma once
#include <filesystem>
#include <string>

#include "dataset/dataset.h"

/// dataset.json, the text half of a packed dataset. Field by field in docs/formats.md.
namespace radiafit {

inline constexpr const char* dataset_json_name = "dataset.json";
inline constexpr const char* dataset_mesh_name = "mesh.ply";
inline constexpr const char* dataset_images_name = "images.bin";
inline constexpr const char* dataset_normals_name = "normals.f32";
/// What an import leaves for people to read, and no fit needs: lamps that it calibrated.
inline constexpr const char* dataset_lamps_name = "lamps.csv";
inline constexpr const char* dataset_lamp_picture_name = "lamps.png";
inline constexpr uint64_t image_alignment = 4096;  ///< of every View::pixel_offset: a page, and what O_DIRECT asks for

/// What dataset.json says of the files beside it.
struct DatasetSizes {
    uint64_t vertices = 0, triangles = 0;
    uint64_t images_bytes = 0;  ///< length of images.bin
    bool grid_normals = false;  ///< a grid's normals are in normals.f32
};

std::string dataset_to_json(const Dataset& dataset, const DatasetSizes& sizes);
/// Everything but the mesh and the normals: of a mesh's normals it has the side, and `grid_normals` says whether a grid
/// has any. `file` names the text in errors (UserError); cameras and values are checked, offsets not.
Dataset dataset_from_json(const std::string& text, const std::filesystem::path& file, DatasetSizes& sizes);

/// Whether it can be a view's gain: from 1e-12 to 1e12. A table's lie between 1e-6 and 1e6 before their mean is taken
/// out.
bool is_gain(const Gain& gain);

/// Throws UserError, prefixed by `name`, for a camera or a camera's direction that is none.
void check_view(const View& view, const std::string& name);

/// The text of a file, or a UserError that says what is missing.
std::string read_dataset_file(const std::filesystem::path& file);

/// Throws UserError, prefixed by `name`, for a normal that is not of unit length to 1e-4.
void check_normals(const std::vector<Vec3f>& normals, const std::string& name);

[[noreturn]] void throw_damaged(const std::filesystem::path& file, const std::string& what);

inline uint64_t pixel_bytes(const Camera& camera, Encoding encoding) {
    return uint64_t(camera.width) * uint64_t(camera.height) * 3 * uint64_t(bytes_per_channel(encoding));
}
inline uint64_t mask_bytes(const Camera& camera) { return (uint64_t(camera.width) + 7) / 8 * uint64_t(camera.height); }

}  // namespace radiafit
