#include "image/color_tags.h"

#include <fmt/format.h>
#include <zlib.h>

#include <utility>

namespace radiafit {
namespace {

using Chromaticities = std::array<double, 8>;

/// By number; others are unspecified, or no primaries'.
constexpr std::pair<int, Chromaticities> numbered_primaries[] = {
    {1, srgb_chromaticities},
    {4, {0.67, 0.33, 0.21, 0.71, 0.14, 0.08, 0.310, 0.316}},
    {5, {0.64, 0.33, 0.29, 0.60, 0.15, 0.06, 0.3127, 0.329}},
    {6, {0.63, 0.34, 0.31, 0.595, 0.155, 0.07, 0.3127, 0.329}},
    {7, {0.63, 0.34, 0.31, 0.595, 0.155, 0.07, 0.3127, 0.329}},
    {8, {0.681, 0.319, 0.243, 0.692, 0.145, 0.049, 0.310, 0.316}},
    {9, {0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.329}},
    {11, {0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.314, 0.351}},
    {12, {0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329}},
    {22, {0.63, 0.34, 0.295, 0.605, 0.155, 0.077, 0.3127, 0.329}}};

}  // namespace

std::string take_numbers(const ColorNumbers& numbers, const char* by, ColorTags& tags) {
    enum Curve { gamma22 = 4, gamma28 = 5, linear = 8, log100 = 9, log316 = 10, pq = 16, dci = 17, hlg = 18 };
    const int curve = numbers.curve;
    if (curve == pq || curve == hlg) return "a picture of high dynamic range (PQ or HLG)";
    if (curve == log100 || curve == log316) return "a picture of logarithms";
    tags = {};
    tags.numbers_by = by;
    for (const auto& [number, chromaticities] : numbered_primaries)
        if (number == numbers.primaries && chromaticities != srgb_chromaticities) tags.chromaticities = chromaticities;
    if (curve == linear) tags.gamma = 1;
    if (curve == gamma22) tags.gamma = 1 / 2.2;
    if (curve == gamma28) tags.gamma = 1 / 2.8;
    if (curve == dci) tags.gamma = 1 / 2.6;
    if (!tags.has_chromaticities() && tags.gamma == 0) tags.srgb = by;
    return "";
}

void take_profile(std::string_view bytes, ColorTags& tags) {
    if (bytes.size() > largest_profile)
        tags.damage = fmt::format("it has {} bytes, more than {}", bytes.size(), largest_profile);
    else
        tags.profile = bytes;
}

void join_profile(const std::vector<std::string_view>& pieces, ColorTags& tags) {
    if (pieces.empty()) return;
    std::vector<std::string_view> ordered(pieces.size());
    size_t bytes = 0;
    for (const std::string_view piece : pieces) {
        const size_t number = piece.size() < 2 ? 0 : uint8_t(piece[0]);
        if (number < 1 || number > ordered.size() || uint8_t(piece[1]) != ordered.size() ||
            ordered[number - 1].data()) {
            tags.damage = "its pieces in the file are not complete";
            return;
        }
        ordered[number - 1] = piece.substr(2);
        bytes += piece.size() - 2;
    }
    std::string whole;
    whole.reserve(bytes);
    for (const std::string_view piece : ordered) whole += piece;
    take_profile(whole, tags);
}

void unpack_profile(std::string_view chunk, ColorTags& tags) {
    const size_t name = chunk.find('\0');
    if (name == std::string_view::npos || name + 2 > chunk.size() || chunk[name + 1] != 0) {
        tags.damage = "its PNG chunk is damaged";
        return;
    }
    const std::string_view packed = chunk.substr(name + 2);
    z_stream stream = {};
    if (inflateInit(&stream) != Z_OK) return;
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // zlib reads only
    stream.avail_in = static_cast<uInt>(packed.size());
    std::string profile;
    std::array<char, 1 << 14> piece;
    int code = Z_OK;
    while (code == Z_OK && profile.size() <= largest_profile) {
        stream.next_out = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_out = static_cast<uInt>(piece.size());
        code = inflate(&stream, Z_NO_FLUSH);
        profile.append(piece.data(), piece.size() - stream.avail_out);
    }
    inflateEnd(&stream);
    if (profile.size() > largest_profile)
        take_profile(profile, tags);
    else if (code != Z_STREAM_END)
        tags.damage = "it does not unpack";
    else
        take_profile(profile, tags);
}

}  // namespace radiafit
