#include "base/printable.h"

#include <fmt/format.h>

#include <cstdint>

namespace radiafit {
namespace {

/// Bytes of the UTF-8 character that `text` begins with; 0: it begins with none.
size_t character_size(std::string_view text) {
    const auto byte = [&](size_t i) { return i < text.size() ? uint8_t(text[i]) : uint8_t(0); };
    const uint8_t first = byte(0);
    const size_t size = first < 0x80   ? 1
                        : first < 0xc2 ? 0
                        : first < 0xe0 ? 2
                        : first < 0xf0 ? 3
                        : first < 0xf5 ? 4
                                       : 0;
    for (size_t i = 1; i < size; ++i)
        if ((byte(i) & 0xc0) != 0x80) return 0;
    return size;
}

/// C0 and C1 controls, and DEL: terminals act on them.
bool is_control(std::string_view character) {
    const auto first = uint8_t(character[0]);
    return first < 0x20 || first == 0x7f || (first == 0xc2 && uint8_t(character[1]) < 0xa0);
}

}  // namespace

std::string printable(std::string_view text, bool keep_lines) {
    std::string out;
    while (!text.empty()) {
        const size_t size = character_size(text);
        const std::string_view character = text.substr(0, size ? size : 1);
        if (character == "\n")
            out += keep_lines ? "\n" : "\\n";
        else if (size == 0 || is_control(character))
            for (const char c : character) out += fmt::format("\\x{:02x}", uint8_t(c));
        else
            out += character;
        text.remove_prefix(character.size());
    }
    return out;
}

}  // namespace radiafit
