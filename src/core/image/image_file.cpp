#include "image/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "base/error.h"
#include "base/read_file.h"
#include "image/image_format.h"
#include "image/image_header.h"
#include "image/raw_image.h"

namespace radiafit {
namespace {

/// What a file's bytes promise, and then the pixels of the same bytes.
RawImage decode_raw(const std::filesystem::path& file, std::string bytes, const HeaderCheck& check,
                    ImageHeader& header) {
    header = read_image_header(file, bytes);
    if (check) check(int(header.width), int(header.height));
    return header.format->read_pixels(file, std::move(bytes), header);
}

RawImage read_raw(const std::filesystem::path& file, const HeaderCheck& check, ImageHeader& header) {
    return decode_raw(file, read_file(file, "image file"), check, header);
}

void check_colors(const std::filesystem::path& file, const RawImage& raw) {
    if (raw.colors() != 1 && raw.colors() != 3)
        throw UserError(fmt::format("{}: has {} colour channels, neither grey nor RGB: convert the image to RGB",
                                    file.string(), raw.colors()));
}

/// From 0 to 255, rounded. Not a number is 0.
uint8_t to_byte(uint8_t value) { return value; }
uint8_t to_byte(uint16_t value) { return uint8_t((value + 128u) / 257u); }
uint8_t to_byte(float value) { return value > 0 ? uint8_t(std::lround(255 * std::min(value, 1.0f))) : uint8_t(0); }

template <class Channel>
std::vector<Channel> spread_colors(const RawImage& raw, std::vector<Channel>& values) {
    if (raw.channels == 3 && raw.alpha < 0) return std::move(values);
    const auto channels = size_t(raw.channels);
    const size_t pixels = values.size() / channels;
    size_t places[3];
    for (int c = 0; c < 3; ++c) places[c] = size_t(raw.color(raw.colors() == 3 ? c : 0));
    std::vector<Channel> rgb(pixels * 3);
    for (size_t i = 0; i < pixels; ++i)
        for (size_t c = 0; c < 3; ++c) rgb[3 * i + c] = values[i * channels + places[c]];
    return rgb;
}

template <class Channel>
std::vector<uint8_t> take_alpha(const RawImage& raw, const std::vector<Channel>& values) {
    if (raw.alpha < 0) return {};
    const auto channels = size_t(raw.channels);
    std::vector<uint8_t> alpha(values.size() / channels);
    for (size_t i = 0; i < alpha.size(); ++i) alpha[i] = to_byte(values[i * channels + size_t(raw.alpha)]);
    return alpha;
}

/// The largest colour channel of every pixel, times alpha.
template <class Channel>
std::vector<uint8_t> grey_values(const RawImage& raw, const std::vector<Channel>& values) {
    std::vector<uint8_t> grey(size_t(raw.width) * size_t(raw.height), 0);
    for (size_t i = 0; i < grey.size(); ++i) {
        const Channel* pixel = values.data() + i * size_t(raw.channels);
        for (int c = 0; c < raw.colors(); ++c) grey[i] = std::max(grey[i], to_byte(pixel[raw.color(c)]));
        if (raw.alpha >= 0) grey[i] = uint8_t(grey[i] * to_byte(pixel[raw.alpha]) / 255);
    }
    return grey;
}

/// Numbers of 16 bits that would fit into 8, such as labels, become 8-bit values.
void narrow_numbers(RawImage& raw) {
    const auto* wide = std::get_if<std::vector<uint16_t>>(&raw.values);
    if (!wide || raw.alpha >= 0 || std::ranges::any_of(*wide, [](uint16_t value) { return value > 255; })) return;
    raw.values = std::vector<uint8_t>(wide->begin(), wide->end());
}

ImageFile image_of(const std::filesystem::path& file, RawImage raw, ImageHeader header, bool floats) {
    check_colors(file, raw);
    ImageFile image;
    image.grey = raw.colors() == 1;
    image.format = header.format->name;
    image.orientation = header.orientation;
    image.colors = std::move(header.colors);
    image.remarks = std::move(header.remarks);
    image.width = raw.width;
    image.height = raw.height;
    image.linear = raw.linear;
    const auto take = [&]<class Channel>(std::vector<Channel>& values) {
        image.bits = 8 * int(sizeof(Channel));
        if (image.bits == 32 && !floats)
            throw UserError(
                fmt::format("{}: channels are floats, neither 8 nor 16 bits: convert the image to PNG", file.string()));
        image.alpha = take_alpha(raw, values);
        if constexpr (sizeof(Channel) == 1) image.rgb8 = spread_colors(raw, values);
        if constexpr (sizeof(Channel) == 2) image.rgb16 = spread_colors(raw, values);
        if constexpr (sizeof(Channel) == 4) image.rgb32 = spread_colors(raw, values);
    };
    std::visit(take, raw.values);
    return image;
}

}  // namespace

ImageFile read_image(const std::filesystem::path& file, bool floats, const HeaderCheck& check) {
    ImageHeader header;
    RawImage raw = read_raw(file, check, header);
    return image_of(file, std::move(raw), std::move(header), floats);
}

ImageFile decode_image(const std::filesystem::path& file, std::string bytes, const HeaderCheck& check) {
    ImageHeader header;
    RawImage raw = decode_raw(file, std::move(bytes), check, header);
    return image_of(file, std::move(raw), std::move(header), false);
}

MaskFile read_mask(const std::filesystem::path& file, const HeaderCheck& check) {
    ImageHeader header;
    RawImage raw = read_raw(file, check, header);
    check_colors(file, raw);
    narrow_numbers(raw);
    MaskFile mask;
    mask.width = raw.width;
    mask.height = raw.height;
    mask.values = std::visit([&](const auto& values) { return grey_values(raw, values); }, raw.values);
    std::array<bool, 256> present{};
    for (const uint8_t value : mask.values) {
        present[value] = true;
        mask.largest = std::max(mask.largest, int(value));
    }
    constexpr ptrdiff_t most_labels = 16;
    const bool numbers = mask.largest > 0 && mask.largest < 128 && std::ranges::count(present, true) <= most_labels &&
                         !header.format->lossy;
    mask.labels = numbers && mask.largest > 1;
    const int threshold = numbers ? 1 : 128;
    for (uint8_t& value : mask.values) value = value >= threshold ? 255 : 0;
    return mask;
}

}  // namespace radiafit
