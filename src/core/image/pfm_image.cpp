#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "image/codecs.h"

namespace radiafit {
namespace {

struct PfmHeader {
    uint64_t channels = 1, width = 0, height = 0;
    float scale = 0;
    size_t bytes = 0;  ///< of the header
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// The next word; `at` moves behind the one blank that ends it.
std::string_view take_word(std::string_view bytes, size_t& at) {
    while (at < bytes.size() && (is_blank(bytes[at]) || bytes[at] == '#')) {
        if (bytes[at] == '#') at = std::min(bytes.find('\n', at), bytes.size() - 1);
        ++at;
    }
    const size_t begin = at = std::min(at, bytes.size());
    while (at < bytes.size() && !is_blank(bytes[at])) ++at;
    return bytes.substr(begin, at++ - begin);
}

template <class Number>
Number take_number(const std::filesystem::path& file, std::string_view bytes, size_t& at) {
    const std::string_view word = take_word(bytes, at);
    Number number = 0;
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (word.empty() || code != std::errc() || end != word.data() + word.size() || at > bytes.size())
        fail_damaged_image(file, "a PFM header without width, height and scale");
    return number;
}

PfmHeader read_header(const std::filesystem::path& file, std::string_view bytes) {
    PfmHeader header;
    size_t at = 0;
    header.channels = take_word(bytes, at) == "PF" ? 3 : 1;
    header.width = take_number<uint32_t>(file, bytes, at);
    header.height = take_number<uint32_t>(file, bytes, at);
    header.scale = take_number<float>(file, bytes, at);
    if (!std::isfinite(header.scale) || header.scale == 0) fail_damaged_image(file, "a PFM of no scale");
    header.bytes = at;
    return header;
}

}  // namespace

ImageHeader read_pfm_header(const std::filesystem::path& file, std::string_view bytes) {
    const PfmHeader header = read_header(file, bytes);
    return {header.width, header.height, header.channels * 32};
}

RawImage read_pfm_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader&) {
    const PfmHeader header = read_header(file, bytes);
    const size_t row = header.width * header.channels;
    if ((bytes.size() - header.bytes) / 4 < row * header.height)
        fail_damaged_image(file, "the file ends within the picture");
    RawImage image;
    image.width = int(header.width);
    image.height = int(header.height);
    image.channels = int(header.channels);
    std::vector<float> values(row * header.height);
    for (size_t y = 0; y < header.height; ++y)
        std::memcpy(values.data() + (header.height - 1 - y) * row, bytes.data() + header.bytes + y * row * 4, row * 4);
    for (float& value : values) {
        if (header.scale > 0) value = std::bit_cast<float>(__builtin_bswap32(std::bit_cast<uint32_t>(value)));
        value *= std::abs(header.scale);
    }
    image.values = std::move(values);
    return image;
}

}  // namespace radiafit
