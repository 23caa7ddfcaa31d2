#include "base/exr_attribute.h"

#include <cstdint>
#include <cstring>
#include <utility>

namespace radiafit {
namespace {

constexpr std::pair<std::string_view, size_t> lengths[] = {{"box2f", 16},
                                                           {"box2i", 16},
                                                           {"chromaticities", 32},
                                                           {"compression", 1},
                                                           {"deepImageState", 1},
                                                           {"double", 8},
                                                           {"envmap", 1},
                                                           {"float", 4},
                                                           {"int", 4},
                                                           {"keycode", 28},
                                                           {"lineOrder", 1},
                                                           {"m33d", 72},
                                                           {"m33f", 36},
                                                           {"m44d", 128},
                                                           {"m44f", 64},
                                                           {"rational", 8},
                                                           {"tiledesc", 9},
                                                           {"timecode", 8},
                                                           {"v2d", 16},
                                                           {"v2f", 8},
                                                           {"v2i", 8},
                                                           {"v3d", 24},
                                                           {"v3f", 12},
                                                           {"v3i", 12}};

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

}  // namespace

bool exr_attribute_fits(std::string_view type, std::string_view value) {
    if (type == "chlist") return is_channel_list(value);
    if (type == "preview") return is_preview(value);
    for (const auto& [name, length] : lengths)
        if (type == name) return value.size() == length;
    return true;
}

}  // namespace radiafit
