#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dataset/grid.h"
#include "geometry/atlas.h"
#include "geometry/camera.h"
#include "geometry/light.h"
#include "geometry/mesh.h"
#include "model/value_curve.h"

/// The packed dataset: the only thing a fitting program reads. A folder with dataset.json, images.bin and mesh.ply (or
/// a grid of texels in its place), described field by field in docs/formats.md.
namespace radiafit {

enum class Encoding { u8_srgb, u8_linear, u16_linear, f16_linear, f32_linear };
std::string to_string(Encoding encoding);  ///< as in dataset.json: "u8-srgb"
int bytes_per_channel(Encoding encoding);

/// What an image's linear values are multiplied by before they are fitted: one number, or one per channel.
struct Gain {
    std::array<double, 3> channels;

    Gain(double all = 1) : channels{all, all, all} {}
    explicit Gain(const std::array<double, 3>& rgb) : channels(rgb) {}
    double operator[](size_t channel) const { return channels[channel]; }
    bool uniform() const { return channels[0] == channels[1] && channels[0] == channels[2]; }
    double least() const { return *std::min_element(channels.begin(), channels.end()); }
    double most() const { return *std::max_element(channels.begin(), channels.end()); }
    bool operator==(const Gain&) const = default;
};

/// One posed photograph.
struct View {
    std::string name;
    Camera camera;  ///< of the stored (cropped) rectangle
    /// For a grid's image taken from so far that all rays are parallel: unit direction to the camera, world space. Then
    /// `camera` has a width and a height and nothing else.
    std::optional<Vec3d> camera_direction;
    std::optional<Light>
        light;              ///< what lit this image, where the light moves; all views of a dataset have one, or none
    bool held_out = false;  ///< never fitted, only judged
    /// Linear: fitted values are encode(gain * decode(stored)); 1 where exposure was fixed. One number where there is a
    /// light, whose intensity has the colours.
    Gain gain;
    uint64_t pixel_offset = 0;  ///< byte offset in images.bin of [height][width][3], row 0 on top; multiple of 4096
    /// Byte offset of [height][ceil(width / 8)] bytes, most significant bit first, 1 = object.
    std::optional<uint64_t> mask_offset;
    float peak = 1;  ///< largest stored value, for f16_linear and f32_linear; 1 for every other encoding
    /// hash_bytes() of the image's bytes in images.bin (image_block_bytes() of them); none before version 4.
    std::optional<uint64_t> checksum;
    std::array<int, 2> crop_origin = {0, 0};  ///< column and row of the rectangle in the photograph: information only
    std::array<int, 2> full_size = {0, 0};    ///< width and height of the photograph; 0, 0: not cropped

    /// Unit direction from x (world space) to the camera.
    Vec3d direction_to_camera(const Vec3d& x) const {
        return camera_direction ? *camera_direction : Vec3d((camera.center() - x).normalized());
    }
};

/// Unit normals in world space finer than the mesh's: one for each texel of a TriangleAtlas of that side.
struct NormalMap {
    int side = 0;                ///< 0: there is none, normals are those of the mesh
    std::vector<Vec3f> normals;  ///< [F * side (side + 1) / 2] in texel order
};

struct Dataset {
    std::filesystem::path folder;
    std::string name;         ///< "star", "bust", or the capture's
    std::string description;  ///< one sentence; synthetic sets say that they are stand-ins
    std::string source;       ///< provenance: command line or capture, and terms
    Encoding encoding = Encoding::u8_srgb;
    Mesh mesh;  ///< empty if there is a grid
    Grid grid;
    std::vector<View> views;
    NormalMap normal_map;                       ///< of a mesh
    std::map<std::string, uint64_t> checksums;  ///< file_checksum() of the other files by name; empty before version 4

    bool has_grid() const { return grid.width > 0; }
    bool light_moves() const { return !views.empty() && views.front().light.has_value(); }
    std::vector<uint32_t> split(bool held_out) const;  ///< indices into views
    uint64_t image_bytes() const;                      ///< raw pixels of all views, masks and padding left out
};

/// Reads and checks a packed dataset whole, all but the pixels (sizes, offsets, cameras, mesh or grid). Throws
/// UserError that names file and cure. Pixels are checked as they are streamed (ImageStream), or all at once by
/// check_pixels().
Dataset open_dataset(const std::filesystem::path& folder);

/// Throws UserError for a dataset that no light field map can be fitted to: a grid, or light that moves.
void require_light_field(const Dataset& dataset);
/// Throws UserError for a dataset that no reflectance model can be fitted to: one without lights.
void require_lights(const Dataset& dataset);

/// The atlas that a reflectance model is fitted on: with the dataset's normal map, where it has one. Throws UserError
/// if that was made for another side. The dataset must outlive the atlas.
TriangleAtlas reflectance_atlas(const Dataset& dataset, int side);
/// The same, or a grid's, for which `side` is unused.
std::unique_ptr<Atlas> texel_atlas(const Dataset& dataset, int side);

/// Throws UserError if something other than a packed dataset, a damaged one included, or an empty folder is there, or a
/// dataset to which somebody added files.
void check_dataset_target(const std::filesystem::path& folder);

/// Writes a packed dataset under a temporary name beside `folder`; nothing is visible there before finish().
/// An unfinished writer removes its temporary folder. An existing dataset (even a damaged one) is replaced whole, an
/// empty folder too; anything else at `folder` is a UserError, raised by the constructor.
class DatasetWriter {
public:
    explicit DatasetWriter(const std::filesystem::path& folder);
    ~DatasetWriter();
    DatasetWriter(const DatasetWriter&) = delete;
    DatasetWriter& operator=(const DatasetWriter&) = delete;

    /// pixels: [height][width][3] in `header.encoding`; mask: [height][width], non-zero = object, or empty.
    /// view's offsets and peak are filled in here. UserError for a bad camera, light or gain, for float values that are
    /// not finite, and for a light where the first view had none, or the other way about.
    void add(View view, const void* pixels, const std::vector<uint8_t>& mask);
    /// Everything but the images: folder, encoding and views of `header` are ignored. It has a mesh or a grid; all
    /// views over a grid have the grid's size.
    void finish(const Dataset& header);
    void set_encoding(Encoding encoding);  ///< before the first add; u8_srgb unless set
    /// Where the files are until finish(): for files to be written beside the images (truth.h).
    const std::filesystem::path& temporary_folder() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Linear light of a stored value in [0, 1] or above, and back.
double decode(Encoding encoding, double stored);
double encode(Encoding encoding, double linear);

}  // namespace radiafit
