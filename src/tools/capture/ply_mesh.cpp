#include "capture/ply_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "base/text_file.h"
#include "capture/ply_header.h"

namespace radiafit::tools {
namespace {

static_assert(std::endian::native == std::endian::little, "little-endian files are read as they are");

/// The numbers of a text file's body: one entry per line.
class TextBody {
public:
    TextBody(const std::filesystem::path& file, const PlyHeader& header, std::string body)
        : text_(file, std::move(body), header.lines) {}

    void begin_entry(const PlyElement& element, uint64_t) {
        std::string_view line;
        do {
            if (!text_.next_line(line))
                fail(fmt::format("the file ends before the last '{}': copy or export the mesh again", element.name));
        } while (line.empty());
        words_ = split_tokens(line);
        at_ = 0;
    }
    double next(PlyType type) {
        const std::string_view word = next_word();
        if (type.kind != PlyType::Kind::real) return double(text_.to_signed(word, "a value"));
        return to_coordinate(text_, word, "a value");
    }
    void skip(PlyType) { next_word(); }
    void end_entry() {
        if (at_ != words_.size()) fail("more numbers than the header has properties: export the mesh again");
    }
    void expect_end() {
        for (std::string_view line; text_.next_line(line);)
            if (!line.empty()) fail("more lines than the header counts: export the mesh again");
    }
    [[noreturn]] void fail(const std::string& problem) const { text_.fail(problem); }

private:
    std::string_view next_word() {
        if (at_ == words_.size()) fail("fewer numbers than the header has properties: export the mesh again");
        return words_[at_++];
    }

    TextFile text_;
    std::vector<std::string_view> words_;  ///< of the current line
    size_t at_ = 0;
};

/// The numbers of a binary file's body.
class BinaryBody {
public:
    BinaryBody(const std::filesystem::path& file, const PlyHeader& header, std::string content)
        : file_(file),
          content_(std::move(content)),
          at_(header.bytes),
          swapped_(header.format == PlyHeader::Format::big_endian) {}

    void begin_entry(const PlyElement& element, uint64_t index) { element_ = &element, index_ = index; }
    double next(PlyType type) {
        const char* from = take(size_t(type.bytes));
        using Kind = PlyType::Kind;
        if (type.kind == Kind::real) return type.bytes == 4 ? double(to<float>(from)) : to<double>(from);
        if (type.kind == Kind::whole)
            return type.bytes == 1 ? to<int8_t>(from) : type.bytes == 2 ? to<int16_t>(from) : to<int32_t>(from);
        return type.bytes == 1 ? to<uint8_t>(from) : type.bytes == 2 ? to<uint16_t>(from) : to<uint32_t>(from);
    }
    void skip(PlyType type) { take(size_t(type.bytes)); }
    void end_entry() {}
    /// Some writers end the file by a line break.
    void expect_end() const {
        const std::string_view rest = std::string_view(content_).substr(at_);
        if (rest.find_first_not_of("\r\n") != std::string_view::npos)
            throw UserError(
                fmt::format("{}: {} bytes follow the last entry that the header counts: export the mesh again",
                            file_.string(), rest.size()));
    }
    [[noreturn]] void fail(const std::string& problem) const {
        throw UserError(
            fmt::format("{}: {} {} of {}: {}", file_.string(), element_->name, index_, element_->count, problem));
    }

private:
    const char* take(size_t bytes) {
        if (bytes > content_.size() - at_) fail("the file ends here: copy or export the mesh again");
        at_ += bytes;
        return content_.data() + at_ - bytes;
    }
    template <class T>
    T to(const char* from) const {
        std::array<char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), from, sizeof(T));
        if (swapped_) std::reverse(bytes.begin(), bytes.end());
        return std::bit_cast<T>(bytes);
    }

    std::filesystem::path file_;
    std::string content_;
    size_t at_;
    bool swapped_;
    const PlyElement* element_ = nullptr;  ///< with index_: the current entry, for messages
    uint64_t index_ = 0;
};

const PlyElement* find_element(const PlyHeader& header, std::string_view name) {
    for (const PlyElement& element : header.elements)
        if (element.name == name) return &element;
    return nullptr;
}

/// Takes the surface out of either body.
template <class Body>
class PlyReader {
public:
    PlyReader(const PlyHeader& header, Body body) : header_(header), body_(std::move(body)) {
        if (const PlyElement* vertices = find_element(header, "vertex")) vertices_ = vertices->count;
    }

    RawMesh read() {
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex") raw_.positions.reserve(element.count);
            if (element.name == "face") raw_.triangles.reserve(element.count);
            for (uint64_t i = 0; i < element.count; ++i) {
                body_.begin_entry(element, i);
                read_entry(element);
                body_.end_entry();
            }
        }
        body_.expect_end();
        raw_.cut_polygons();
        return std::move(raw_);
    }

private:
    void read_entry(const PlyElement& element) {
        if (element.name == "vertex") return read_vertex(element);
        for (const PlyProperty& p : element.properties) {
            const bool corners = p.length && (p.name == "vertex_indices" || p.name == "vertex_index");
            if (corners && element.name == "face")
                read_face(p);
            else if (corners && element.name == "tristrips")
                read_strips(p);
            else
                skip(p);
        }
    }

    void read_vertex(const PlyElement& element) {
        Vec3d position = Vec3d::Zero();
        for (const PlyProperty& p : element.properties) {
            const int axis = p.length || p.name.size() != 1 ? 3 : p.name[0] - 'x';
            if (axis >= 0 && axis < 3)
                position[axis] = body_.next(p.type);
            else
                skip(p);
        }
        if (!position.cast<float>().allFinite()) body_.fail("its position is not finite: repair the mesh");
        raw_.positions.push_back(position);
    }

    void read_face(const PlyProperty& list) {
        corners_.clear();
        for (uint64_t n = length(list); n > 0; --n) corners_.push_back(to_corner(body_.next(list.type)));
        raw_.add_polygon(corners_);
    }

    /// Strips of triangles one after the other, -1 between them.
    void read_strips(const PlyProperty& list) {
        corners_.clear();
        const auto end_strip = [&] {
            if (!corners_.empty()) raw_.add_strip(corners_);
            corners_.clear();
        };
        for (uint64_t n = length(list); n > 0; --n) {
            const double index = body_.next(list.type);
            if (index == -1)
                end_strip();
            else
                corners_.push_back(to_corner(index));
        }
        end_strip();
    }

    uint32_t to_corner(double index) const {
        if (!(index >= 0 && index < double(vertices_) && index == std::floor(index)))
            body_.fail(
                fmt::format("refers to vertex {}, but they are numbered from 0 to below {}: export the mesh again",
                            index, vertices_));
        return static_cast<uint32_t>(index);
    }

    void skip(const PlyProperty& property) {
        for (uint64_t n = property.length ? length(property) : 1; n > 0; --n) body_.skip(property.type);
    }

    uint64_t length(const PlyProperty& list) {
        const double items = body_.next(*list.length);
        if (items < 0) body_.fail("has a list of fewer than no items: export the mesh again");
        return static_cast<uint64_t>(items);
    }

    const PlyHeader& header_;
    Body body_;
    uint64_t vertices_ = 0;
    RawMesh raw_;
    std::vector<uint32_t> corners_;  ///< of the current face
};

void check_surface(const std::filesystem::path& file, const PlyHeader& header) {
    const auto fail = [&](const char* problem) {
        throw UserError(fmt::format("{}: {}: export the mesh with vertices and faces", file.string(), problem));
    };
    const PlyElement* vertices = find_element(header, "vertex");
    if (!vertices || vertices->count == 0) fail("empty mesh: no vertices in it");
    for (const char* axis : {"x", "y", "z"}) {
        const auto is_axis = [&](const PlyProperty& p) { return p.name == axis && !p.length; };
        if (std::none_of(vertices->properties.begin(), vertices->properties.end(), is_axis))
            fail("its vertices have no x, y and z");
    }
    if (vertices->count > std::numeric_limits<uint32_t>::max()) fail("more vertices than 32 bits number");
}

}  // namespace

RawMesh read_ply_mesh(const std::filesystem::path& file, std::string content) {
    const PlyHeader header = read_ply_header(file, content);
    check_surface(file, header);
    if (header.format != PlyHeader::Format::ascii)
        return PlyReader(header, BinaryBody(file, header, std::move(content))).read();
    content.erase(0, header.bytes);
    return PlyReader(header, TextBody(file, header, std::move(content))).read();
}

}  // namespace radiafit::tools
