#include "dataset/dataset.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "dataset/dataset_json.h"
#include "dataset/mesh_ply.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

void check_range(const fs::path& file, const View& view, const char* what, uint64_t offset, uint64_t bytes,
                 uint64_t file_bytes) {
    if (offset > file_bytes || bytes > file_bytes - offset)
        throw_damaged(file, fmt::format("the {} of view \"{}\" ends at byte {}, but the file ends at {}", what,
                                        view.name, offset + bytes, file_bytes));
}

/// normals.f32 for normal_map.side, of a dataset whose mesh is there.
void read_normals(const fs::path& file, Dataset& dataset) {
    const size_t side = size_t(dataset.normal_map.side), count = dataset.mesh.triangle_count() * side * (side + 1) / 2;
    std::error_code error;
    const uint64_t bytes = fs::file_size(file, error);
    if (error) throw_damaged(file, "the file is missing or cannot be read");
    if (bytes != count * sizeof(Vec3f))
        throw_damaged(file, fmt::format("the file has {} bytes, but {} triangles of {} texels need {}", bytes,
                                        dataset.mesh.triangle_count(), side * (side + 1) / 2, count * sizeof(Vec3f)));
    dataset.normal_map.normals.resize(count);
    InputFile(file).read(dataset.normal_map.normals.data(), 0, bytes);
    check_normals(dataset.normal_map.normals, file.string());
}

}  // namespace

void check_normals(const std::vector<Vec3f>& normals, const std::string& name) {
    for (size_t i = 0; i < normals.size(); ++i)
        if (!(std::abs(normals[i].norm() - 1) < 1e-4f))  // not a number either
            throw UserError(fmt::format("{}: normal {} is ({}, {}, {}), not of unit length; normalize it", name, i,
                                        normals[i].x(), normals[i].y(), normals[i].z()));
}

std::vector<uint32_t> Dataset::split(bool held_out) const {
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < views.size(); ++i)
        if (views[i].held_out == held_out) indices.push_back(i);
    return indices;
}

uint64_t Dataset::image_bytes() const {
    uint64_t bytes = 0;
    for (const View& view : views) bytes += pixel_bytes(view.camera, encoding);
    return bytes;
}

TriangleAtlas reflectance_atlas(const Dataset& dataset, int side) {
    TriangleAtlas atlas(dataset.mesh, side);
    const NormalMap& map = dataset.normal_map;
    if (map.side == 0) return atlas;
    if (map.side != side)
        throw UserError(fmt::format("{}: its normals were made for surface side {}, not {}; fit with --surface-side {}",
                                    dataset.folder.string(), map.side, side, map.side));
    atlas.set_normals(map.normals);
    return atlas;
}

Dataset open_dataset(const fs::path& folder) {
    const fs::path json_file = folder / dataset_json_name;
    DatasetSizes sizes;
    Dataset dataset = dataset_from_json(read_dataset_file(json_file), json_file, sizes);

    const fs::path images_file = folder / dataset_images_name;
    std::error_code error;
    const uint64_t images_bytes = fs::file_size(images_file, error);
    if (error) throw_damaged(images_file, "the file is missing or cannot be read");
    if (images_bytes != sizes.images_bytes)
        throw_damaged(images_file, fmt::format("the file has {} bytes, but {} says {}", images_bytes, dataset_json_name,
                                               sizes.images_bytes));
    for (const View& view : dataset.views) {
        if (view.pixel_offset % image_alignment != 0)
            throw_damaged(json_file, fmt::format("the pixels of view \"{}\" start at byte {}, not a multiple of {}",
                                                 view.name, view.pixel_offset, image_alignment));
        check_range(images_file, view, "image", view.pixel_offset, pixel_bytes(view.camera, dataset.encoding),
                    images_bytes);
        if (view.mask_offset)
            check_range(images_file, view, "mask", *view.mask_offset, mask_bytes(view.camera), images_bytes);
    }

    const fs::path mesh_file = folder / dataset_mesh_name;
    dataset.mesh = read_ply(mesh_file);
    if (dataset.mesh.vertex_count() != sizes.vertices || dataset.mesh.triangle_count() != sizes.triangles)
        throw_damaged(mesh_file,
                      fmt::format("{} vertices and {} triangles, but {} says {} and {}", dataset.mesh.vertex_count(),
                                  dataset.mesh.triangle_count(), dataset_json_name, sizes.vertices, sizes.triangles));
    if (dataset.normal_map.side > 0) read_normals(folder / dataset_normals_name, dataset);
    return dataset;
}

}  // namespace radiafit
