#include "dataset/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/wording.h"
#include "dataset/checksums.h"
#include "dataset/dataset_json.h"
#include "dataset/mesh_ply.h"
#include "dataset/value_file.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

/// A part of images.bin.
struct Range {
    uint64_t begin, end;
    const View* view;
    const char* what;  ///< "image" or "mask"
};

Range range_of(const View& view, const char* what, uint64_t begin, uint64_t bytes, const fs::path& file,
               uint64_t file_bytes) {
    if (begin > file_bytes || bytes > file_bytes - begin)
        throw_damaged(file, fmt::format("the {} of view \"{}\" ends at byte {}, but the file ends at {}", what,
                                        view.name, begin + bytes, file_bytes));
    return {begin, begin + bytes, &view, what};
}

/// Throws unless the pixels and masks of all views lie within the file and don't overlap.
void check_places(const Dataset& dataset, const fs::path& images_file, uint64_t file_bytes) {
    const fs::path json_file = dataset.folder / dataset_json_name;
    std::vector<Range> ranges;
    for (const View& view : dataset.views) {
        if (view.pixel_offset % image_alignment != 0)
            throw_damaged(json_file, fmt::format("the pixels of view \"{}\" start at byte {}, not a multiple of {}",
                                                 view.name, view.pixel_offset, image_alignment));
        const uint64_t bytes = pixel_bytes(view.camera, dataset.encoding);
        ranges.push_back(range_of(view, "image", view.pixel_offset, bytes, images_file, file_bytes));
        if (view.mask_offset)
            ranges.push_back(
                range_of(view, "mask", *view.mask_offset, mask_bytes(view.camera), images_file, file_bytes));
        if (!view.checksum) continue;
        range_of(view, "block", view.pixel_offset, image_block_bytes(view, dataset.encoding), images_file, file_bytes);
        if (view.mask_offset && *view.mask_offset != view.pixel_offset + bytes)
            throw_damaged(json_file, fmt::format("the mask of view \"{}\" starts at byte {}, but its pixels end at {}",
                                                 view.name, *view.mask_offset, view.pixel_offset + bytes));
    }
    std::ranges::sort(ranges, {}, &Range::begin);
    for (size_t i = 1; i < ranges.size(); ++i)
        if (const Range& a = ranges[i - 1], &b = ranges[i]; b.begin < a.end)
            throw_damaged(json_file, fmt::format("the {} of view \"{}\" overlaps the {} of view \"{}\"", b.what,
                                                 b.view->name, a.what, a.view->name));
}

std::vector<Vec3f> read_normals(const fs::path& file, size_t count, const std::string& whose) {
    return read_values<Vec3f>(file, count, whose, throw_damaged);
}

void read_mesh(const fs::path& folder, const DatasetSizes& sizes, Dataset& dataset) {
    const fs::path mesh_file = folder / dataset_mesh_name, normals_file = folder / dataset_normals_name;
    dataset.mesh = read_ply(mesh_file);
    const size_t vertices = dataset.mesh.vertex_count(), triangles = dataset.mesh.triangle_count();
    if (vertices != sizes.vertices || triangles != sizes.triangles)
        throw_damaged(mesh_file, fmt::format("{} vertices and {} triangles, but {} says {} and {}", vertices, triangles,
                                             dataset_json_name, sizes.vertices, sizes.triangles));
    if (dataset.normal_map.side == 0) return;
    const size_t side = size_t(dataset.normal_map.side), tile = side * (side + 1) / 2;
    dataset.normal_map.normals =
        read_normals(normals_file, triangles * tile, fmt::format("{} triangles of {} texels", triangles, tile));
    check_normals(dataset.normal_map.normals, normals_file.string());
}

void read_grid(const fs::path& folder, const DatasetSizes& sizes, Grid& grid) {
    check_grid(grid, (folder / dataset_json_name).string());
    if (!sizes.grid_normals) return;
    const fs::path file = folder / dataset_normals_name;
    grid.texel_normals = read_normals(file, grid.texel_count(), fmt::format("{} x {} texels", grid.width, grid.height));
    check_grid(grid, file.string());
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
        throw UserError(fmt::format("{}: its normals were made for surface side {}, not {}; fit with {} {}",
                                    dataset.folder.string(), map.side, side, option_name("surface-side"), map.side));
    atlas.set_normals(map.normals);
    return atlas;
}

std::unique_ptr<Atlas> texel_atlas(const Dataset& dataset, int side) {
    if (dataset.has_grid()) return std::make_unique<GridAtlas>(make_atlas(dataset.grid));
    return std::make_unique<TriangleAtlas>(reflectance_atlas(dataset, side));
}

void require_light_field(const Dataset& dataset) {
    const char* why = dataset.has_grid()      ? "a grid of texels without a mesh"
                      : dataset.light_moves() ? "lit by a lamp that moves"
                                              : nullptr;
    if (why)
        throw UserError(
            fmt::format("{}: {}, made for reflectance models; a light field map needs a mesh under light that stays{}",
                        dataset.folder.string(), why, at_command_line(", as `radiafit import colmap` packs it", "")));
}

void require_lights(const Dataset& dataset) {
    if (dataset.light_moves()) return;
    throw UserError(fmt::format("{}: no image says what lit it; a reflectance model needs a lamp per image{}",
                                dataset.folder.string(),
                                at_command_line(", as `radiafit import lights` and `radiafit generate ornament` pack "
                                                "them; or fit a light field map (--model lfm)",
                                                "; or fit a light field map")));
}

namespace {

/// `description`: the text of dataset.json.
Dataset open_described(const fs::path& folder, const std::string& description) {
    const fs::path json_file = folder / dataset_json_name;
    DatasetSizes sizes;
    Dataset dataset = dataset_from_json(description, json_file, sizes);

    const fs::path images_file = folder / dataset_images_name;
    std::error_code error;
    const uint64_t images_bytes = fs::file_size(images_file, error);
    if (error) throw_damaged(images_file, "the file is missing or cannot be read");
    if (images_bytes != sizes.images_bytes)
        throw_damaged(images_file, fmt::format("the file has {} bytes, but {} says {}", images_bytes, dataset_json_name,
                                               sizes.images_bytes));
    check_places(dataset, images_file, images_bytes);

    if (dataset.has_grid())
        read_grid(folder, sizes, dataset.grid);
    else
        read_mesh(folder, sizes, dataset);
    for (const char* name : {dataset_mesh_name, dataset_normals_name}) check_file(dataset, name);
    return dataset;
}

}  // namespace

Dataset open_dataset(const fs::path& folder) {
    const fs::path json_file = folder / dataset_json_name;
    for (int tries = 1;; ++tries) {
        const std::string description = read_dataset_file(json_file);
        try {
            return open_described(folder, description);
        } catch (const UserError&) {
            // Files of two datasets, if another one took the folder's place in between.
            if (tries == 10 || read_dataset_file(json_file) == description) throw;
        }
    }
}

}  // namespace radiafit
