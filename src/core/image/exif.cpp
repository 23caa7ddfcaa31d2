#include "image/exif.h"

namespace radiafit {
namespace {

/// A number of a TIFF; nothing beyond the end.
std::optional<uint64_t> number_at(std::string_view bytes, uint64_t at, uint64_t size, bool big_endian) {
    if (at > bytes.size() || size > bytes.size() - at) return {};
    uint64_t value = 0;
    for (uint64_t i = 0; i < size; ++i) value = value << 8 | uint8_t(bytes[at + (big_endian ? i : size - 1 - i)]);
    return value;
}

/// Bytes of one number of an entry's type; 0: of a type that nobody here asks for.
uint64_t type_size(uint64_t type) {
    if (type == 1 || type == 2 || type == 6 || type == 7) return 1;
    if (type == 3) return 2;
    if (type == 4) return 4;
    if (type == 5) return 8;  // a fraction: two of 4 bytes
    return 0;
}

}  // namespace

std::optional<TiffValue> find_tiff_value(std::string_view tiff, uint16_t tag, std::optional<uint64_t> directory) {
    const bool big_endian = tiff.starts_with("MM");
    const auto number = [&](uint64_t at, uint64_t size) { return number_at(tiff, at, size, big_endian); };
    const auto version = number(2, 2);
    if (!(big_endian || tiff.starts_with("II")) || !version || (*version != 42 && *version != 43)) return {};
    const bool wide = *version == 43;  // BigTIFF
    const uint64_t word = wide ? 8 : 4, count_bytes = wide ? 8 : 2, entry_bytes = wide ? 20 : 12;
    const auto begin = directory ? directory : wide ? number(8, 8) : number(4, 4);
    if (!begin || *begin > tiff.size()) return {};
    const auto count = number(*begin, count_bytes);
    for (uint64_t i = 0; count && i < *count; ++i) {
        const uint64_t at = *begin + count_bytes + i * entry_bytes;
        const auto found = number(at, 2), type = number(at + 2, 2), length = number(at + 4, word);
        if (!length || !found || !type) return {};
        if (*found != tag) continue;
        const uint64_t size = type_size(*type);
        if (size == 0 || *length > tiff.size()) return {};
        const uint64_t bytes = *length * size;
        const auto place = bytes <= word ? std::optional<uint64_t>(at + 4 + word) : number(at + 4 + word, word);
        if (!place || *place > tiff.size() || bytes > tiff.size() - *place) return {};
        return TiffValue{tiff.substr(*place, bytes), int(size), big_endian};
    }
    return {};
}

std::vector<double> tiff_fractions(std::string_view tiff, uint16_t tag) {
    const auto value = find_tiff_value(tiff, tag);
    if (!value || value->size != 8) return {};
    std::vector<double> result;
    for (uint64_t at = 0; at < value->bytes.size(); at += 8) {
        const auto above = number_at(value->bytes, at, 4, value->big_endian);
        const auto below = number_at(value->bytes, at + 4, 4, value->big_endian);
        if (!above || !below || *below == 0) return {};
        result.push_back(double(*above) / double(*below));
    }
    return result;
}

bool exif_says_adobe_rgb(std::string_view exif) {
    constexpr uint16_t exif_directory = 34665, interoperability_directory = 40965, index = 1;
    std::optional<uint64_t> directory;
    for (const uint16_t tag : {exif_directory, interoperability_directory}) {
        const auto value = find_tiff_value(exif, tag, directory);
        directory = value ? number_at(value->bytes, 0, uint64_t(value->size), value->big_endian) : std::nullopt;
        if (!directory) return false;
    }
    const auto value = find_tiff_value(exif, index, directory);
    return value && value->bytes.starts_with("R03");
}

int tiff_orientation(std::string_view tiff) {
    const auto value = find_tiff_value(tiff, 274);
    if (!value) return 1;
    const auto number = number_at(value->bytes, 0, uint64_t(value->size), value->big_endian);
    return number && *number >= 1 && *number <= 8 ? int(*number) : 1;
}

}  // namespace radiafit
