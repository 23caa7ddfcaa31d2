#include "pieces.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/read_file.h"
#include "page/html_table.h"

namespace radiafit::harness {
namespace {

constexpr size_t largest_svg = 200'000;  ///< bytes

std::string as_class(std::string text) {
    std::ranges::replace(text, ' ', '-');
    return text;
}

std::string in_words(std::string column) {
    std::ranges::replace(column, '_', ' ');
    return column;
}

/// What a column says where that is the same in all of several rows; empty otherwise.
std::string constant(const CsvTable& rows, const std::string& column) {
    if (rows.row_count() < 2) return "";
    const std::string& first = rows.text(0, column);
    for (size_t i = 1; i < rows.row_count(); ++i)
        if (rows.text(i, column) != first) return "";
    return first;
}

/// A side of a PNG file, from its header.
int png_side(const std::string& png, size_t at) {
    int side = 0;
    for (size_t i = at; i < at + 4 && i < png.size(); ++i) side = side << 8 | static_cast<unsigned char>(png[i]);
    return side;
}

}  // namespace

Html verdict_mark(const std::string& verdict) {
    return element("span", {{"class", "verdict " + as_class(verdict)}}, verdict);
}

Html not_run(const std::string& why) {
    return element("p", {{"class", "nothing"}}, verdict_mark("not run") << " " << why);
}

Html command_line(const std::string& command) { return element("code", {{"class", "command"}}, command); }

Html link(const std::string& target, const Html& inside) { return element("a", {{"href", target}}, inside); }

Html rows_table(const RunRecord& run, const std::string& file) {
    const CsvTable rows = read_rows(run, file);
    std::vector<std::string> columns, header, same;
    for (const std::string& column : rows.header()) {
        if (const std::string text = constant(rows, column); !text.empty()) {
            same.push_back(fmt::format("{} {}", in_words(column), text));
        } else {
            columns.push_back(column);
            header.push_back(in_words(column));
        }
    }
    Table table(header);
    for (size_t i = 0; i < rows.row_count(); ++i) {
        std::vector<std::string> fields;
        for (const std::string& column : columns) fields.push_back(rows.text(i, column));
        table.add(std::move(fields));
    }
    Html caption = element("code", file);
    if (!same.empty()) caption << fmt::format("; in all rows: {}", fmt::join(same, ", "));
    return scroll_box(file, html_table(caption, table));
}

Html image(const std::filesystem::path& files, const std::string& alt) {
    const std::string svg = read_file(files.string() + ".svg", "figure"),
                      png = read_file(files.string() + ".png", "figure");
    const bool sharp = svg.size() <= largest_svg || svg.size() <= png.size();
    return empty_element("img", {{"src", sharp ? data_uri("image/svg+xml", svg) : data_uri("image/png", png)},
                                 {"alt", alt},
                                 {"width", std::to_string(png_side(png, 16))},
                                 {"height", std::to_string(png_side(png, 20))}});
}

}  // namespace radiafit::harness
