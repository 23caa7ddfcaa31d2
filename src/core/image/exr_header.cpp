#include "image/exr_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace radiafit {
namespace {

/// Bytes of a value, and the types that have so many.
constexpr std::pair<size_t, std::string_view> lengths[] = {{1, " compression deepImageState envmap lineOrder "},
                                                           {4, " float int "},
                                                           {8, " double rational timecode v2f v2i "},
                                                           {9, " tiledesc "},
                                                           {12, " v3f v3i "},
                                                           {16, " box2f box2i v2d "},
                                                           {24, " v3d "},
                                                           {28, " keycode "},
                                                           {32, " chromaticities "},
                                                           {36, " m33f "},
                                                           {64, " m44f "},
                                                           {72, " m33d "},
                                                           {128, " m44d "}};

/// Names that zero bytes end, each with 16 bytes; an empty name ends the list.
bool is_channel_list(std::string_view value) {
    while (true) {
        const size_t end = value.find('\0');
        if (end == std::string_view::npos) return false;
        if (end == 0) return value.size() == 1;
        if (value.size() < end + 1 + 16) return false;
        value.remove_prefix(end + 1 + 16);
    }
}

/// Width, height, and four bytes a pixel.
bool is_preview(std::string_view value) {
    uint32_t side[2];
    if (value.size() < sizeof side) return false;
    std::memcpy(side, value.data(), sizeof side);
    const uint64_t bytes = value.size() - sizeof side;
    return bytes % 4 == 0 && uint64_t(side[0]) * side[1] == bytes / 4;
}

/// A number of the file, which is little-endian as this machine is.
template <class T>
T number(std::istream& in) {
    T value = 0;
    in.read(reinterpret_cast<char*>(&value), sizeof value);
    return value;
}

/// A text that a zero byte ends.
std::string take_text(std::istream& in) {
    char text[256];  // no name is longer
    in.getline(text, sizeof text, '\0');
    if (!in || in.eof()) throw std::runtime_error("an OpenEXR name does not end");
    return text;
}

/// The channels of a list: after each name 16 bytes: its type, four of no meaning here, steps in x and y.
void take_channels(ExrHeader& header, std::string_view list) {
    header.bits_per_pixel = 0;
    while (list.size() > 1) {
        const size_t end = list.find('\0');
        header.channels.emplace_back(list.substr(0, end));
        list.remove_prefix(end + 1);
        uint32_t words[4];
        std::memcpy(words, list.data(), sizeof words);
        header.bits_per_pixel += words[0] == 1 ? 16 : 32;  // half; unsigned or float
        header.subsampled |= words[2] != 1 || words[3] != 1;
        list.remove_prefix(16);
    }
}

void take_attribute(ExrHeader& header, std::string_view name, std::string_view type, std::string_view value) {
    if (name == "channels" && type == "chlist") take_channels(header, value);
    if (name == "displayWindow" && type == "box2i") std::memcpy(header.display.data(), value.data(), 16);
    if (name == "chromaticities" && type == "chromaticities")
        std::memcpy(header.chromaticities.data(), value.data(), 32);
    uint32_t side[2];
    if (name == "tiles" && value.size() >= sizeof side) {
        std::memcpy(side, value.data(), sizeof side);
        header.tile = std::max(side[0], side[1]);
    }
    if (name == "dataWindow" && type == "box2i") {
        if (header.sized) throw std::runtime_error("two data windows");
        header.sized = true;
        std::memcpy(header.data.data(), value.data(), sizeof header.data);
        header.width = int64_t(header.data[2]) - header.data[0] + 1;
        header.height = int64_t(header.data[3]) - header.data[1] + 1;
    }
}

}  // namespace

ExrHeader walk_exr_header(std::istream& in, uint64_t bytes) {
    number<uint32_t>(in);  // magic
    constexpr uint32_t deep = 1 << 11, multipart = 1 << 12;
    ExrHeader header;
    header.plain = (number<uint32_t>(in) & (deep | multipart)) == 0;
    constexpr std::array<int32_t, 4> no_window = {0, 0, -1, -1};
    header.display = no_window;
    while (header.plain) {
        const std::string name = take_text(in);
        if (name.empty()) {
            if (header.bits_per_pixel == 0 || !header.sized)
                throw std::runtime_error("an OpenEXR header without data window or channels");
            if (header.display == no_window) header.display = header.data;
            break;
        }
        const std::string type = take_text(in);
        const auto length = number<uint32_t>(in);
        std::string value(std::min<uint64_t>(length, bytes), '\0');
        in.read(value.data(), std::streamsize(value.size()));
        if (!in || value.size() < length) throw std::runtime_error("its header ends within an attribute");
        if (!exr_attribute_fits(type, value)) throw std::runtime_error("its attribute " + name + " is damaged");
        take_attribute(header, name, type, value);
    }
    return header;
}

bool exr_attribute_fits(std::string_view type, std::string_view value) {
    if (type == "chlist") return is_channel_list(value);
    if (type == "preview") return is_preview(value);
    for (const auto& [length, types] : lengths)
        if (types.find(fmt::format(" {} ", type)) != std::string_view::npos) return value.size() == length;
    return true;
}

}  // namespace radiafit
