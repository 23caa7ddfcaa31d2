#include "report/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <stdexcept>

#include "base/csv_record.h"
#include "base/error.h"
#include "base/read_file.h"

namespace radiafit::harness {
namespace {

std::string quoted(const std::string& field) {
    if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
    std::string result = "\"";
    for (const char c : field) {
        if (c == '"') result += '"';
        result += c;
    }
    return result + '"';
}

}  // namespace

CsvWriter::CsvWriter(std::filesystem::path path, std::vector<std::string> header)
    : file_(path), path_(std::move(path)), columns_(header.size()) {
    const std::set<std::string> names(header.begin(), header.end());
    if (header.empty() || names.size() != header.size() || names.contains(""))
        throw std::logic_error(fmt::format("{}: the header needs names, each once", path_.string()));
    write(header);
}

void CsvWriter::row(const std::vector<std::string>& fields) {
    if (fields.size() != columns_)
        throw std::logic_error(
            fmt::format("{}: a row of {} fields under {} names", path_.string(), fields.size(), columns_));
    write(fields);
}

void CsvWriter::write(const std::vector<std::string>& fields) {
    std::string line;
    for (size_t i = 0; i < fields.size(); i++) line += (i == 0 ? "" : ",") + quoted(fields[i]);
    file_.write(line + '\n');
}

void CsvWriter::commit() { file_.commit(); }

CsvTable::CsvTable(std::filesystem::path path) : CsvTable(path, read_file(path, "file of rows")) {}

CsvTable::CsvTable(std::filesystem::path path, std::string text) : path_(std::move(path)) {
    if (text.empty()) throw UserError(fmt::format("{}: empty; remake it", path_.string()));
    if (!text.ends_with('\n'))
        throw UserError(fmt::format("{}: no line break behind the last row, so it may have been cut; remake the file",
                                    path_.string()));
    std::string_view rest = text;
    size_t line = 1;
    const auto record = [&] {
        const std::string_view before = rest;
        std::optional<std::vector<std::string>> fields = take_csv_record(rest);
        if (!fields)
            throw UserError(
                fmt::format("{}:{}: a quote is never closed; correct or remake the file", path_.string(), line));
        line += size_t(std::ranges::count(before.substr(0, before.size() - rest.size()), '\n'));
        return *std::move(fields);
    };
    header_ = record();
    while (!rest.empty()) {
        lines_.push_back(line);
        rows_.push_back(record());
        if (rows_.back().size() != header_.size())
            throw UserError(fmt::format("{}:{}: {} fields under {} names; correct or remake the file", path_.string(),
                                        lines_.back(), rows_.back().size(), header_.size()));
    }
}

size_t CsvTable::index_of(std::string_view column) const {
    const auto found = std::ranges::find(header_, column);
    if (found == header_.end())
        throw UserError(fmt::format("{}: no column '{}'; remake the file with this version", path_.string(), column));
    return static_cast<size_t>(found - header_.begin());
}

const std::string& CsvTable::text(size_t row, std::string_view column) const { return rows_.at(row)[index_of(column)]; }

double CsvTable::number(size_t row, std::string_view column) const {
    const std::string& field = text(row, column);
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc{} || end != field.data() + field.size())
        throw UserError(fmt::format("{}:{}: '{}' in column '{}' is no number; correct or remake the file",
                                    path_.string(), lines_[row], field, column));
    return value;
}

}  // namespace radiafit::harness
