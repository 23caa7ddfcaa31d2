#include "report/table.h"

#include <algorithm>
#include <stdexcept>

namespace radiafit::harness {
namespace {

using Line = std::vector<std::string>;

/// Characters, not bytes: every byte of UTF-8 but its continuations starts one.
size_t length(const std::string& text) {
    return static_cast<size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

bool starts_like_number(const std::string& field) {
    const size_t sign = field.starts_with('-') || field.starts_with('+') ? 1 : 0;
    return field.size() > sign && field[sign] >= '0' && field[sign] <= '9';
}

std::string padded(const std::string& field, size_t width, bool right) {
    const std::string blanks(width - length(field), ' ');
    return right ? blanks + field : field + blanks;
}

}  // namespace

void Table::add(std::vector<std::string> fields) {
    if (fields.size() != header_.size()) throw std::logic_error("Table::add: as many fields as the header, please");
    rows_.push_back(std::move(fields));
}

bool Table::numeric(size_t column) const {
    const auto empty = [&](const Line& row) { return row[column].empty(); };
    return !std::ranges::all_of(rows_, empty) &&
           std::ranges::all_of(rows_, [&](const Line& row) { return empty(row) || starts_like_number(row[column]); });
}

std::vector<Table::Column> Table::columns(const std::vector<Line>& lines) const {
    std::vector<Column> result;
    for (size_t i = 0; i < header_.size(); i++) {
        Column column{.width = 3, .right = numeric(i)};  // three: the least a Markdown rule takes
        for (const Line& line : lines) column.width = std::max(column.width, length(line[i]));
        result.push_back(column);
    }
    return result;
}

std::string Table::text() const {
    std::vector<Line> lines{header_};
    lines.insert(lines.end(), rows_.begin(), rows_.end());
    const std::vector<Column> columns = this->columns(lines);
    std::string result;
    for (size_t k = 0; k < lines.size(); k++) {
        std::string line;
        std::string rule;
        for (size_t i = 0; i < columns.size(); i++) {
            line += (i == 0 ? "" : "  ") + padded(lines[k][i], columns[i].width, columns[i].right);
            rule += (i == 0 ? "" : "  ") + std::string(columns[i].width, '-');
        }
        line.erase(line.find_last_not_of(' ') + 1);
        result += line + '\n';
        if (k == 0) result += rule + '\n';
    }
    return result;
}

std::string Table::markdown() const {
    std::vector<Line> lines{header_};
    lines.insert(lines.end(), rows_.begin(), rows_.end());
    for (Line& line : lines)
        for (std::string& field : line)
            for (size_t at = 0; (at = field.find_first_of("|\n", at)) != std::string::npos; at += 2)
                field.replace(at, 1, field[at] == '|' ? "\\|" : "  ");
    const std::vector<Column> columns = this->columns(lines);
    std::string result;
    for (size_t k = 0; k < lines.size(); k++) {
        std::string line = "|";
        std::string rule = "|";
        for (size_t i = 0; i < columns.size(); i++) {
            const auto& [width, right] = columns[i];
            line += ' ' + padded(lines[k][i], width, right) + " |";
            rule += ' ' + std::string(width - 1, '-') + (right ? ": |" : "- |");
        }
        result += line + '\n';
        if (k == 0) result += rule + '\n';
    }
    return result;
}

}  // namespace radiafit::harness
