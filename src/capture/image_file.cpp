#include "capture/image_file.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

#include "base/error.h"

namespace radiafit {
namespace {

namespace oiio = OIIO;

std::string one_line(std::string message) {
    while (!message.empty() && message.back() == '\n') message.pop_back();
    for (size_t at; (at = message.find('\n')) != std::string::npos;) message.replace(at, 1, "; ");
    return message;
}

[[noreturn]] void fail_damaged(const std::filesystem::path& file, const std::string& why) {
    throw UserError(fmt::format("{}: truncated or corrupt image ({}): copy or export it again", file.string(),
                                why.empty() ? "it cannot be read whole" : one_line(why)));
}

/// A PNG's chunks, lengths and checksums, before libpng sees the file: OpenImageIO's reader does not check all
/// checksums, and libpng prints a line of its own.
void check_png(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    constexpr uint8_t signature[8] = {137, 80, 78, 71, 13, 10, 26, 10};
    uint8_t head[8] = {};
    stream.read(reinterpret_cast<char*>(head), 8);
    if (!stream || !std::equal(head, head + 4, signature)) return;  // no PNG: another reader judges it
    if (!std::equal(head, head + 8, signature)) fail_damaged(file, "PNG signature differs");
    const auto big_endian = [](const uint8_t* b) {
        return uint32_t{b[0]} << 24 | uint32_t{b[1]} << 16 | uint32_t{b[2]} << 8 | uint32_t{b[3]};
    };
    const uint64_t size = std::filesystem::file_size(file);
    std::vector<uint8_t> chunk;  // type and data
    for (uint64_t at = 8;;) {
        stream.read(reinterpret_cast<char*>(head), 4);
        const uint64_t length = big_endian(head);
        if (!stream || at + 12 + length > size) fail_damaged(file, "the file ends within a PNG chunk");
        chunk.resize(4 + length);
        stream.read(reinterpret_cast<char*>(chunk.data()), static_cast<std::streamsize>(chunk.size()));
        stream.read(reinterpret_cast<char*>(head), 4);
        if (!stream) fail_damaged(file, "the file ends within a PNG chunk");
        if (crc32_z(0, chunk.data(), chunk.size()) != big_endian(head)) fail_damaged(file, "PNG checksum differs");
        if (std::equal(chunk.begin(), chunk.begin() + 4, "IEND")) return;
        at += 12 + length;
    }
}

struct OpenImage {
    std::unique_ptr<oiio::ImageInput> input;
    int channels, alpha;  ///< alpha: its channel, or -1
    int colors() const { return channels - (alpha >= 0 ? 1 : 0); }
};

/// Which channel types are taken.
enum class Depths { integers, floats_too, any };

OpenImage open_image(const std::filesystem::path& file, ImageFile& header, Depths depths) {
    if (!std::filesystem::is_regular_file(file))
        throw UserError(fmt::format("{}: no such image file: check the folder and the name", file.string()));
    check_png(file);
    oiio::ImageSpec config;
    config["oiio:UnassociatedAlpha"] = 1;
    OpenImage image{oiio::ImageInput::open(file.string(), &config), 0, -1};
    if (!image.input) fail_damaged(file, oiio::geterror());
    const oiio::ImageSpec& spec = image.input->spec();
    header.width = spec.width;
    header.height = spec.height;
    image.channels = spec.nchannels;
    image.alpha = spec.alpha_channel;
    if (spec.format == oiio::TypeDesc::UINT8) {
        header.bits = 8;
    } else if (spec.format == oiio::TypeDesc::UINT16) {
        header.bits = 16;
        const std::string space = spec.get_string_attribute("oiio:ColorSpace");
        header.linear = space == "Linear" || space == "linear" || space == "scene_linear";
    } else if (spec.format == oiio::TypeDesc::HALF || spec.format == oiio::TypeDesc::FLOAT) {
        header.bits = 32;
    } else {
        header.bits = 0;
    }
    if (depths == Depths::integers && header.bits != 8 && header.bits != 16)
        throw UserError(fmt::format("{}: channels are of type {}, neither 8 nor 16 bits: convert the image to PNG",
                                    file.string(), spec.format.c_str()));
    if (depths == Depths::floats_too && header.bits == 0)
        throw UserError(
            fmt::format("{}: channels are of type {}, neither 8 or 16 bits nor float: convert the image to "
                        "PNG or EXR",
                        file.string(), spec.format.c_str()));
    if (image.colors() != 1 && image.colors() != 3)
        throw UserError(fmt::format("{}: has {} colour channels, neither grey nor RGB: convert the image to RGB",
                                    file.string(), image.colors()));
    return image;
}

/// All channels of the file, interleaved. libjpeg fills what is missing with grey and only warns: a warning counts.
template <class Channel>
std::vector<Channel> read_channels(const std::filesystem::path& file, OpenImage& image, const ImageFile& header) {
    std::vector<Channel> raw(size_t(header.width) * size_t(header.height) * size_t(image.channels));
    const auto type = sizeof(Channel) == 1   ? oiio::TypeDesc::UINT8
                      : sizeof(Channel) == 2 ? oiio::TypeDesc::UINT16
                                             : oiio::TypeDesc::FLOAT;
    const bool complete = image.input->read_image(0, 0, 0, image.channels, type, raw.data());
    if (!complete || image.input->has_error()) fail_damaged(file, image.input->geterror());
    return raw;
}

template <class Channel>
std::vector<Channel> spread_colors(const std::vector<Channel>& raw, const OpenImage& image) {
    const auto channels = size_t(image.channels);
    const size_t pixels = raw.size() / channels;
    // The alpha channel comes last in every format that OpenImageIO reads into grey or RGB.
    std::vector<Channel> rgb(pixels * 3);
    for (size_t i = 0; i < pixels; ++i)
        for (size_t c = 0; c < 3; ++c) rgb[3 * i + c] = raw[i * channels + (image.colors() == 3 ? c : 0)];
    return rgb;
}

template <class Channel>
std::vector<uint8_t> take_alpha(const std::vector<Channel>& raw, const OpenImage& image) {
    if (image.alpha < 0) return {};
    const auto channels = size_t(image.channels);
    std::vector<uint8_t> alpha(raw.size() / channels);
    for (size_t i = 0; i < alpha.size(); ++i) {
        const Channel value = raw[i * channels + size_t(image.alpha)];
        if constexpr (sizeof(Channel) == 4)
            alpha[i] = uint8_t(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
        else
            alpha[i] = sizeof(Channel) == 1 ? uint8_t(value) : uint8_t((value + 128u) / 257u);
    }
    return alpha;
}

}  // namespace

ImageFile read_image(const std::filesystem::path& file, bool floats) {
    ImageFile image;
    OpenImage open = open_image(file, image, floats ? Depths::floats_too : Depths::integers);
    const auto take = [&]<class Channel>(std::vector<Channel>& rgb) {
        const auto raw = read_channels<Channel>(file, open, image);
        image.alpha = take_alpha(raw, open);
        rgb = spread_colors(raw, open);
    };
    if (image.bits == 8) take(image.rgb8);
    if (image.bits == 16) take(image.rgb16);
    if (image.bits == 32) take(image.rgb32);
    return image;
}

MaskFile read_mask(const std::filesystem::path& file) {
    ImageFile header;
    OpenImage open = open_image(file, header, Depths::any);
    const auto raw = read_channels<uint8_t>(file, open, header);  // other depths are scaled to 8 bits
    MaskFile mask{header.width, header.height, {}};
    mask.values.resize(size_t(header.width) * size_t(header.height));
    uint8_t largest = 0;
    for (size_t i = 0; i < mask.values.size(); ++i) {
        const uint8_t* pixel = raw.data() + i * size_t(open.channels);
        uint8_t value = *std::max_element(pixel, pixel + open.colors());
        if (open.alpha >= 0) value = uint8_t(value * pixel[open.alpha] / 255);
        mask.values[i] = value;
        largest = std::max(largest, value);
    }
    const int threshold = largest == 1 ? 1 : 128;
    for (uint8_t& value : mask.values) value = value >= threshold ? 255 : 0;
    return mask;
}

}  // namespace radiafit
