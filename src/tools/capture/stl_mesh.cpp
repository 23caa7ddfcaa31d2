#include "capture/stl_mesh.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <limits>

#include "base/error.h"

namespace radiafit::tools {
namespace {

static_assert(std::endian::native == std::endian::little, "little-endian files are read as they are");

constexpr size_t stl_header_bytes = 84, stl_triangle_bytes = 50;

/// Of a binary file: three times as many vertices are numbered by 32 bits.
uint64_t promised_stl_triangles(std::string_view content) {
    uint32_t count = 0;
    if (content.size() >= stl_header_bytes)
        std::memcpy(&count, content.data() + stl_header_bytes - sizeof count, sizeof count);
    return count;
}

bool is_binary(std::string_view content) {
    return content.size() >= stl_header_bytes &&
           content.size() == stl_header_bytes + stl_triangle_bytes * promised_stl_triangles(content);
}

void add_triangle(RawMesh& raw) {
    const auto first = static_cast<uint32_t>(raw.positions.size() - 3);
    raw.triangles.push_back({first, first + 1, first + 2});
}

RawMesh read_binary(const std::filesystem::path& file, std::string_view content) {
    const uint64_t count = promised_stl_triangles(content);
    if (count > std::numeric_limits<uint32_t>::max() / 3)
        throw UserError(fmt::format("{}: more vertices than 32 bits number: simplify the mesh", file.string()));
    RawMesh raw;
    raw.positions.reserve(count * 3);
    raw.triangles.reserve(count);
    for (uint64_t t = 0; t < count; ++t) {
        float numbers[12];  // the normal, and three corners
        std::memcpy(numbers, content.data() + stl_header_bytes + t * stl_triangle_bytes, sizeof numbers);
        for (int k = 3; k < 12; k += 3) {
            const Vec3f corner(numbers[k], numbers[k + 1], numbers[k + 2]);
            if (!corner.allFinite())
                throw UserError(fmt::format("{}: triangle {} of {}: a position is not finite: repair the mesh",
                                            file.string(), t, count));
            raw.positions.push_back(corner.cast<double>());
        }
        add_triangle(raw);
    }
    return raw;
}

class StlText {
public:
    StlText(const std::filesystem::path& file, std::string content) : file_(file), text_(file, std::move(content), 0) {}

    /// Facets of one loop of three vertices, of any number of solids.
    RawMesh read() {
        while (next_words()) {
            expect("solid");
            for (;;) {
                require_words();
                if (word_is(0, "endsolid")) break;
                read_facet();
            }
        }
        return std::move(raw_);
    }

private:
    void read_facet() {
        expect("facet");  // a normal follows
        require_words();
        expect("outer");
        for (int k = 0; k < 3; ++k) {
            require_words();
            expect("vertex");
            if (words_.size() != 4) text_.fail("a vertex takes three numbers: export the mesh again");
            raw_.positions.emplace_back(to_coordinate(text_, words_[1], "x"), to_coordinate(text_, words_[2], "y"),
                                        to_coordinate(text_, words_[3], "z"));
        }
        require_words();
        expect("endloop");
        require_words();
        expect("endfacet");
        add_triangle(raw_);
    }

    bool next_words() {
        for (std::string_view line; text_.next_line(line);) {
            words_ = split_tokens(line);
            if (!words_.empty()) return true;
        }
        return false;
    }
    void require_words() {
        if (!next_words())
            throw UserError(
                fmt::format("{}: the file ends before 'endsolid': copy or export the mesh again", file_.string()));
    }
    /// In letters of either size.
    bool word_is(size_t index, std::string_view wanted) const {
        if (index >= words_.size() || words_[index].size() != wanted.size()) return false;
        for (size_t k = 0; k < wanted.size(); ++k)
            if ((words_[index][k] | 0x20) != wanted[k]) return false;
        return true;
    }
    void expect(std::string_view word) const {
        if (!word_is(0, word))
            text_.fail(fmt::format("expected '{}', not '{}': export the mesh again", word, words_[0]));
    }

    std::filesystem::path file_;
    TextFile text_;
    RawMesh raw_;
    std::vector<std::string_view> words_;  ///< of the current line
};

}  // namespace

RawMesh read_stl_mesh(const std::filesystem::path& file, std::string content) {
    RawMesh raw;
    if (is_binary(content)) {
        raw = read_binary(file, content);
    } else {
        const size_t first = content.find_first_not_of(" \t\r\n\xef\xbb\xbf");
        const auto begins = [&](const char* word) {
            return first != std::string::npos && content.compare(first, 5, word) == 0;
        };
        // Some programs begin binary files by this word, too; a cut one is no text then.
        const bool text = begins("solid") || begins("SOLID");
        if (!text || content.find('\0') != std::string::npos)
            throw UserError(fmt::format("{}: {} bytes, but its {} triangles take {}: copy or export the mesh again",
                                        file.string(), content.size(), promised_stl_triangles(content),
                                        stl_header_bytes + stl_triangle_bytes * promised_stl_triangles(content)));
        raw = StlText(file, std::move(content)).read();
    }
    raw.remarks.push_back("STL names no unit: its numbers are taken in the calibration's");
    return raw;
}

}  // namespace radiafit::tools
