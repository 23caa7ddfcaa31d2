#include "image/color_tags.h"

#include <fmt/format.h>
#include <zlib.h>

namespace radiafit {

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
