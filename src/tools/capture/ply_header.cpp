#include "capture/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/text_file.h"

namespace radiafit::tools {
namespace {

constexpr const char* cure = "export the mesh again";

struct NamedType {
    std::string_view name, other_name;
    PlyType type;
};
using Kind = PlyType::Kind;
constexpr std::array<NamedType, 8> types = {{{"char", "int8", {1, Kind::whole}},
                                             {"uchar", "uint8", {1, Kind::natural}},
                                             {"short", "int16", {2, Kind::whole}},
                                             {"ushort", "uint16", {2, Kind::natural}},
                                             {"int", "int32", {4, Kind::whole}},
                                             {"uint", "uint32", {4, Kind::natural}},
                                             {"float", "float32", {4, Kind::real}},
                                             {"double", "float64", {8, Kind::real}}}};

using Words = std::vector<std::string_view>;

PlyType to_type(const TextFile& text, std::string_view name) {
    for (const NamedType& t : types)
        if (name == t.name || name == t.other_name) return t.type;
    text.fail(fmt::format("'{}' is no type of PLY: {}", name, cure));
}

PlyHeader::Format to_format(const TextFile& text, const Words& words) {
    const std::string_view name = words.size() == 3 && words[2] == "1.0" ? words[1] : "";
    if (name == "ascii") return PlyHeader::Format::ascii;
    if (name == "binary_little_endian") return PlyHeader::Format::little_endian;
    if (name == "binary_big_endian") return PlyHeader::Format::big_endian;
    text.fail(
        "expected 'format' with ascii, binary_little_endian or binary_big_endian, and 1.0: export the mesh again");
}

template <class Named>
void expect_new_name(const TextFile& text, const std::vector<Named>& list, std::string_view name) {
    if (std::any_of(list.begin(), list.end(), [&](const Named& n) { return n.name == name; }))
        text.fail(fmt::format("'{}' appears a second time: {}", name, cure));
}

void add_element(const TextFile& text, const Words& words, std::vector<PlyElement>& elements) {
    if (words.size() != 3) text.fail(fmt::format("expected 'element NAME COUNT': {}", cure));
    expect_new_name(text, elements, words[1]);
    elements.push_back({std::string(words[1]), text.to_unsigned(words[2], "the element's count"), {}});
}

void add_property(const TextFile& text, const Words& words, std::vector<PlyElement>& elements) {
    const bool list = words.size() == 5 && words[1] == "list";
    if (elements.empty() || (words.size() != 3 && !list))
        text.fail(
            fmt::format("expected 'property TYPE NAME' or 'property list TYPE TYPE NAME' after an element: {}", cure));
    PlyProperty property{std::string(words.back()), to_type(text, words[words.size() - 2]), {}};
    if (list) property.length = to_type(text, words[2]);
    if (list && property.length->kind == Kind::real)
        text.fail(fmt::format("a list's length is no whole number: {}", cure));
    expect_new_name(text, elements.back().properties, property.name);
    elements.back().properties.push_back(std::move(property));
}

/// Bytes up to the line break after end_header.
size_t header_bytes(const std::filesystem::path& file, std::string_view content) {
    constexpr std::string_view mark = "\nend_header";
    const size_t at = content.find(mark);
    const size_t end = at == std::string_view::npos ? at : content.find('\n', at + mark.size());
    if (end == std::string_view::npos)
        throw UserError(fmt::format("{}: the PLY header does not end: copy or export the mesh again", file.string()));
    return end + 1;
}

/// Bytes of one entry at least: in text, every number takes a digit and a blank.
uint64_t least_bytes(const PlyElement& element, PlyHeader::Format format) {
    uint64_t bytes = 0;
    for (const PlyProperty& p : element.properties)
        bytes += format == PlyHeader::Format::ascii ? 2 : uint64_t(p.length.value_or(p.type).bytes);
    return bytes;
}

/// So that no count makes anyone take more memory than the file is long, or count for years.
void check_counts(const std::filesystem::path& file, const PlyHeader& header, uint64_t body) {
    uint64_t left = body;
    for (const PlyElement& element : header.elements) {
        if (element.properties.empty())
            throw UserError(fmt::format("{}: element '{}' has no property: {}", file.string(), element.name, cure));
        const uint64_t least = least_bytes(element, header.format);
        if (element.count > left / least)
            throw UserError(
                fmt::format("{}: the header promises {} entries of '{}', more than the {} bytes after it can hold: "
                            "copy or export the mesh again",
                            file.string(), element.count, element.name, body));
        left -= element.count * least;
    }
}

}  // namespace

bool is_ply(std::string_view content) {
    return content.starts_with("ply\n") || content.starts_with("ply\r") || content.starts_with("ply ");
}

PlyHeader read_ply_header(const std::filesystem::path& file, std::string_view content) {
    PlyHeader header{PlyHeader::Format::ascii, {}, header_bytes(file, content), 0};
    TextFile text(file, std::string(content.substr(0, header.bytes)), 0);
    bool formatted = false;
    std::string_view line;
    for (text.next_line(line); text.next_line(line) && line != "end_header";) {
        const Words words = split_tokens(line);
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
        if (words[0] == "format") {
            header.format = to_format(text, words);
            formatted = true;
        } else if (words[0] == "element") {
            add_element(text, words, header.elements);
        } else if (words[0] == "property") {
            add_property(text, words, header.elements);
        } else {
            text.fail(fmt::format("'{}' does not belong into a PLY header: {}", words[0], cure));
        }
    }
    header.lines = text.line_number();
    if (!formatted) throw UserError(fmt::format("{}: the PLY header names no format: {}", file.string(), cure));
    // One byte more: the last number of a text needs no blank after it.
    check_counts(file, header, content.size() - header.bytes + 1);
    return header;
}

}  // namespace radiafit::tools
