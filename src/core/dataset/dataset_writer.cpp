#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file.h"
#include "base/half.h"
#include "base/hash.h"
#include "base/made_by.h"
#include "dataset/checksums.h"
#include "dataset/dataset_json.h"
#include "dataset/mesh_ply.h"
#include "dataset/truth.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

/// The files of a dataset's folder, which may be replaced with it.
constexpr std::string_view our_files[] = {dataset_json_name,    dataset_mesh_name,  dataset_images_name,
                                          dataset_normals_name, truth_json_name,    truth_parameters_name,
                                          truth_material_name,  dataset_lamps_name, dataset_lamp_picture_name};

}  // namespace

// Only what a writer left may be replaced: nobody's notes or photographs go with it.
void check_dataset_target(const fs::path& folder) {
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (!fs::exists(status)) return;
    if (!fs::is_directory(status))
        throw UserError(fmt::format("{}: a file is there; choose another name for the dataset", folder.string()));
    bool has_json = false, has_files = false;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name == made_by_name) continue;
        if (std::find(std::begin(our_files), std::end(our_files), name) == std::end(our_files))
            throw UserError(
                fmt::format("{}: holds {}, which is no part of a dataset; choose another name or move it away",
                            folder.string(), name));
        has_json |= name == dataset_json_name;
        has_files = true;
    }
    if (error)
        throw UserError(fmt::format("{}: cannot be read ({}); choose another name", folder.string(), error.message()));
    if (has_files && !has_json)
        throw UserError(fmt::format("{}: not a dataset, it has no {}; choose another name or remove it",
                                    folder.string(), dataset_json_name));
}

namespace {

std::vector<uint8_t> pack_mask(const std::vector<uint8_t>& mask, const Camera& camera) {
    const size_t row_bytes = (size_t(camera.width) + 7) / 8;
    std::vector<uint8_t> bits(mask_bytes(camera), 0);
    for (size_t y = 0; y < size_t(camera.height); ++y)
        for (size_t x = 0; x < size_t(camera.width); ++x)
            if (mask[y * size_t(camera.width) + x] != 0) bits[y * row_bytes + x / 8] |= uint8_t(0x80 >> (x % 8));
    return bits;
}

/// Largest of halves or floats.
template <class Stored, class ToFloat>
float largest(const void* pixels, size_t count, const std::string& name, ToFloat to_float) {
    const auto* stored = static_cast<const Stored*>(pixels);
    float peak = 0;
    for (size_t i = 0; i < count; ++i) {
        const float value = to_float(stored[i]);
        if (!std::isfinite(value))
            throw UserError(
                fmt::format("{}: channel {} of pixel {} is not finite; repair the image", name, i % 3, i / 3));
        peak = std::max(peak, value);
    }
    return peak;
}

}  // namespace

struct DatasetWriter::State {
    fs::path folder;  ///< as the user gave it: the name in errors
    AtomicFolder output;
    OutputFile images;
    Encoding encoding = Encoding::u8_srgb;
    std::vector<uint8_t> block;  ///< one image as it goes to the file, reused
    std::vector<View> views;

    explicit State(const fs::path& f)
        : folder(f), output(f, AtomicFolder::Existing::replace), images(output.path() / dataset_images_name) {}
};

DatasetWriter::DatasetWriter(const fs::path& folder) {
    check_dataset_target(folder);
    state_ = std::make_unique<State>(folder);
}

DatasetWriter::~DatasetWriter() = default;

void DatasetWriter::set_encoding(Encoding encoding) {
    if (!state_->views.empty()) throw std::logic_error("DatasetWriter::set_encoding comes before the first add");
    state_->encoding = encoding;
}

void DatasetWriter::add(View view, const void* pixels, const std::vector<uint8_t>& mask) {
    State& s = *state_;
    check_view(view, view.name);
    if (!is_gain(view.gain))
        throw UserError(fmt::format("{}: the gain {} is not from 1e-12 to 1e12; give other gains", view.name,
                                    is_gain(view.gain.least()) ? view.gain.most() : view.gain.least()));
    if (view.light && !view.gain.uniform())
        throw UserError(fmt::format(
            "{}: has a light and a gain per channel; put the colours into the light's intensity", view.name));
    const size_t pixel_count = size_t(view.camera.width) * size_t(view.camera.height);
    if (!mask.empty() && mask.size() != pixel_count)
        throw std::logic_error("DatasetWriter::add takes one mask value per pixel, or none");
    if (view.light) check_light(*view.light, view.name);
    if (!s.views.empty() && view.light.has_value() != s.views.front().light.has_value())
        throw UserError(fmt::format("{}: has {} light, unlike the first image; give all images one, or none", view.name,
                                    view.light ? "a" : "no"));
    view.peak = 1;
    if (s.encoding == Encoding::f16_linear)
        view.peak =
            largest<uint16_t>(pixels, 3 * pixel_count, view.name, [](uint16_t h) { return float_from_half(h); });
    if (s.encoding == Encoding::f32_linear)
        view.peak = largest<float>(pixels, 3 * pixel_count, view.name, [](float x) { return x; });

    const size_t bytes = size_t(pixel_bytes(view.camera, s.encoding));
    view.pixel_offset = s.images.bytes();
    view.mask_offset.reset();
    if (!mask.empty()) view.mask_offset = s.images.bytes() + bytes;
    std::vector<uint8_t>& block = s.block;
    block.assign(image_block_bytes(view, s.encoding), 0);
    std::memcpy(block.data(), pixels, bytes);
    if (!mask.empty()) std::ranges::copy(pack_mask(mask, view.camera), block.begin() + ptrdiff_t(bytes));
    view.checksum = hash_bytes(block.data(), block.size());
    s.images.write(block.data(), block.size());
    s.views.push_back(std::move(view));
}

const fs::path& DatasetWriter::temporary_folder() const { return state_->output.path(); }

void DatasetWriter::finish(const Dataset& header) {
    State& s = *state_;
    if (s.views.empty())
        throw UserError(fmt::format("{}: a dataset needs at least one image; none was added", s.folder.string()));
    const Grid& grid = header.grid;
    const NormalMap& map = header.normal_map;
    const bool has_grid = header.has_grid();
    if (has_grid)
        check_grid(grid, header.name);
    else
        check_mesh(header.mesh, header.name);
    for (const View& view : s.views)
        if (has_grid ? view.camera.width != grid.width || view.camera.height != grid.height
                     : view.camera_direction.has_value())
            throw std::logic_error("DatasetWriter::finish takes views of the grid's size, or pinhole cameras");
    const std::vector<Vec3f>& normals = has_grid ? grid.texel_normals : map.normals;
    if (!normals.empty() || map.side > 0) {
        const size_t tile = size_t(map.side) * size_t(map.side + 1) / 2;
        if (normals.size() != (has_grid ? grid.texel_count() : header.mesh.triangle_count() * tile))
            throw std::logic_error("DatasetWriter::finish takes one normal per texel");
        if (!has_grid) check_normals(normals, header.name);
        OutputFile out(s.output.path() / dataset_normals_name);
        out.write(normals.data(), normals.size() * sizeof(Vec3f));
        out.close();
    }
    s.images.close();

    Dataset dataset;
    dataset.name = header.name;
    dataset.description = header.description;
    dataset.source = header.source;
    dataset.encoding = s.encoding;
    dataset.views = s.views;
    dataset.grid = {grid.width, grid.height, grid.origin, grid.right, grid.down, {}};
    dataset.normal_map.side = has_grid ? 0 : map.side;
    if (!has_grid) write_ply(header.mesh, s.output.path() / dataset_mesh_name);
    for (const std::string_view name : our_files)
        if (const fs::path written = s.output.path() / name; name != dataset_images_name && fs::exists(written))
            dataset.checksums[std::string(name)] = file_checksum(written);
    write_file(s.output.path() / dataset_json_name,
               dataset_to_json(dataset, {header.mesh.vertex_count(), header.mesh.triangle_count(), s.images.bytes(),
                                         has_grid && !normals.empty()}));
    check_dataset_target(s.folder);  // again: something may have been put there meanwhile
    s.output.commit();
}

}  // namespace radiafit
