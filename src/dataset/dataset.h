#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"

/// The packed dataset: the only thing a fitting program reads. A folder with dataset.json, mesh.ply and images.bin,
/// described field by field in docs/formats.md.
namespace radiafit {

enum class Encoding { u8_srgb, u8_linear, u16_linear, f16_linear };
std::string to_string(Encoding encoding);
int bytes_per_channel(Encoding encoding);

/// One posed photograph.
struct View {
    std::string name;
    Camera camera;            ///< of the stored (cropped) rectangle
    bool held_out = false;    ///< never fitted, only judged
    double gain = 1;          ///< linear: fitted values are encode(gain * decode(stored)); 1 where exposure was fixed
    uint64_t pixel_offset = 0;  ///< byte offset in images.bin of [height][width][3], row 0 on top; multiple of 4096
    std::optional<uint64_t> mask_offset;  ///< of [height][ceil(width / 8)] bytes, most significant bit first, 1 = object
};

struct Dataset {
    std::filesystem::path folder;
    std::string name;         ///< "star", "bust", or the capture's
    std::string description;  ///< one sentence; synthetic sets say that they are stand-ins
    std::string source;       ///< provenance: command line or capture, and terms
    Encoding encoding = Encoding::u8_srgb;
    Mesh mesh;
    std::vector<View> views;

    std::vector<uint32_t> split(bool held_out) const;  ///< indices into views
    uint64_t image_bytes() const;                      ///< raw pixels of all views, masks and padding left out
};

/// Reads and checks a packed dataset whole (sizes, offsets, cameras, mesh). Throws UserError that names file and cure.
Dataset open_dataset(const std::filesystem::path& folder);

/// Writes a packed dataset under a temporary name beside `folder`; nothing is visible there before finish().
/// An unfinished writer removes its temporary folder. An existing dataset is replaced whole; anything else that
/// stands at `folder` is a UserError, raised by the constructor.
class DatasetWriter {
public:
    explicit DatasetWriter(std::filesystem::path folder);
    ~DatasetWriter();
    DatasetWriter(const DatasetWriter&) = delete;
    DatasetWriter& operator=(const DatasetWriter&) = delete;

    /// pixels: [height][width][3] in `header.encoding`; mask: [height][width], non-zero = object, or empty.
    /// view's offsets are filled in here.
    void add(View view, const void* pixels, const std::vector<uint8_t>& mask);
    /// Everything but the images: folder and views of `header` are ignored.
    void finish(const Dataset& header);
    void set_encoding(Encoding encoding);  ///< before the first add; u8_srgb unless set

private:
    struct State;
    State* state_;
};

/// sRGB transfer functions (IEC 61966-2-1) on [0, 1], extended linearly in sign.
float srgb_decode(float stored);
float srgb_encode(float linear);

}  // namespace radiafit
