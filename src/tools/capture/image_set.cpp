#include "capture/image_set.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "base/wording.h"
#include "capture/image_scale.h"
#include "dataset/encoding.h"
#include "image/image_file.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

std::string depth_name(int bits) { return bits == 32 ? "floating-point" : fmt::format("{}-bit", bits); }

void check_depth(const ImageFile& image, const fs::path& file, const ImageSetFormat& format) {
    if (image.bits != format.bits)
        throw UserError(fmt::format("{}: has {} channels, but {} has {} ones: export all images alike", file.string(),
                                    depth_name(image.bits), format.first.string(), depth_name(format.bits)));
}

template <class T>
std::vector<uint8_t> bytes_of(const std::vector<T>& values) {
    std::vector<uint8_t> bytes(values.size() * sizeof(T));
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

std::vector<uint8_t> pack_pixels(ImageFile& image, const ImageSetFormat& format) {
    if (format.bits == 8) {
        const bool linear = format.encoding == Encoding::u8_linear;
        if (image.linear != linear) {  // the first image says otherwise
            const std::vector<float>& light = linear_table(8, image.linear);
            for (uint8_t& v : image.rgb8)
                v = static_cast<uint8_t>(
                    std::lround(255 * (linear ? double(light[v]) : srgb_encode(double(light[v])))));
        }
        return std::move(image.rgb8);
    }
    if (format.bits == 32) return bytes_of(image.rgb32);
    if (!image.linear) {
        const std::vector<float>& light = linear_table(16, false);
        for (uint16_t& v : image.rgb16) v = static_cast<uint16_t>(std::lround(65535.0 * double(light[v])));
    }
    return bytes_of(image.rgb16);
}

/// Colours as the file says if `transfer` is auto, else as stored; ImageFile::linear says which values it holds then.
ColorReading take_colors(ImageFile& image, const std::string& transfer) {
    ColorReading reading;
    if (transfer == "auto") reading = convert_colors(image);
    if (reading.kind == ColorReading::Kind::unknown)
        image.linear = transfer == "linear" || (transfer == "auto" && image.bits != 8);
    return reading;
}

}  // namespace

std::vector<uint8_t> without_transparent(std::vector<uint8_t> mask, const std::vector<uint8_t>& alpha) {
    if (mask.empty()) mask.assign(alpha.size(), 255);
    for (size_t i = 0; i < alpha.size(); ++i)
        if (alpha[i] < 128) mask[i] = 0;
    return mask;
}

ImageSetFormat learn_format(const fs::path& file, const std::string& transfer, int depth, int max_size) {
    ImageFile first = read_image(file, true);
    if (depth != 0 && first.bits != depth)
        throw UserError(
            fmt::format("{}: has {} channels, but {} {} was declared: export the image again, or correct "
                        "the declaration",
                        file.string(), depth_name(first.bits), option_name("depth"), depth));
    if (transfer == "srgb" && first.bits == 32)
        throw UserError(fmt::format("{}: holds floats, which are linear: leave {} srgb out", file.string(),
                                    option_name("transfer")));
    const std::array<int, 2> size = size_within(first.width, first.height, max_size);
    ImageSetFormat format{file, size[0], size[1], first.width, first.height, first.bits, {}, {}};
    format.transfer = transfer;
    take_colors(first, transfer);
    format.encoding = first.bits == 32   ? Encoding::f32_linear
                      : first.bits == 16 ? Encoding::u16_linear
                      : first.linear     ? Encoding::u8_linear
                                         : Encoding::u8_srgb;
    return format;
}

std::vector<uint8_t> scaled_mask(const std::vector<uint8_t>& mask, const ImageSetFormat& format) {
    if (mask.empty() || !format.is_scaled()) return mask;
    return scale_down_mask(mask, format.file_width, format.file_height, format.width, format.height);
}

StoredLight::StoredLight(const ImageSetFormat& format)
    : bytes_(size_t(bytes_per_channel(format.encoding))),
      table_(format.bits == 32 ? nullptr : &linear_table(format.bits, format.encoding != Encoding::u8_srgb)),
      clipped_(has_largest_value(format.encoding) ? 0.99f : std::numeric_limits<float>::infinity()) {}

float StoredLight::at(const std::vector<uint8_t>& pixels, size_t i) const {
    const uint8_t* bytes = pixels.data() + i * bytes_;
    if (table_) {
        uint16_t stored = 0;  // little-endian
        std::memcpy(&stored, bytes, bytes_);
        return (*table_)[stored];
    }
    float stored = 0;
    std::memcpy(&stored, bytes, sizeof stored);
    return stored;
}

/// A dataset has finite numbers only.
void require_finite(std::vector<float>& rgb, const std::vector<uint8_t>& mask, const fs::path& file, int width) {
    for (size_t i = 0; i < rgb.size(); ++i) {
        if (std::isfinite(rgb[i])) continue;
        const size_t pixel = i / 3;
        if (mask.empty() || mask[pixel])
            throw UserError(
                fmt::format("{}: the pixel at column {}, row {} is not finite: repair the image, or mask "
                            "the pixel out",
                            file.string(), pixel % size_t(width), pixel / size_t(width)));
        rgb[i] = 0;
    }
}

PackedImage read_packed(const fs::path& file, const ImageSetFormat& format, const std::vector<uint8_t>& mask,
                        PictureFacts* facts) {
    ImageFile image = read_image(file, true, [&](int width, int height) {
        if (width != format.file_width || height != format.file_height)
            throw UserError(fmt::format(
                "{}: {} x {} pixels, but {} has {} x {}: all images are to show the same pixels", file.string(), width,
                height, format.first.string(), format.file_width, format.file_height));
    });
    check_depth(image, file, format);
    PackedImage packed;
    packed.mask = without_transparent(mask, image.alpha);
    const ColorReading colors = take_colors(image, format.transfer);
    if (facts) {
        *facts = facts_of(file.filename().string(), image, colors, image.bits != 8);
        if (format.transfer != "auto") facts->colors.clear();
    }
    require_finite(image.rgb32, packed.mask, file, image.width);
    if (format.is_scaled()) {
        image = scale_down(image, format.width, format.height);
        packed.mask = scaled_mask(packed.mask, format);
    }
    packed.pixels = pack_pixels(image, format);
    return packed;
}

}  // namespace radiafit::tools
