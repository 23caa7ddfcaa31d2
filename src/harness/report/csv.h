#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/atomic_file.h"
#include "base/rings.h"

/// Comma-separated rows, quoted as RFC 4180 says where a field needs it, one header line, lines end in "\n".
namespace radiafit::harness {

/// Rows that appear under their name, whole, at commit(); without it nothing remains.
/// Throws UserError where AtomicFile does.
class CsvWriter {
public:
    /// Throws std::logic_error for an empty header, or a name that is empty or occurs twice.
    CsvWriter(std::filesystem::path path, std::vector<std::string> header);
    /// As many fields as the header has names, or std::logic_error.
    void row(const std::vector<std::string>& fields);
    void commit();

private:
    void write(const std::vector<std::string>& fields);

    AtomicFile file_;
    std::filesystem::path path_;
    size_t columns_;
};

/// A CSV file in memory. Its errors are UserErrors that name file and line.
class CsvTable {
public:
    /// Throws for an unreadable file, an unfinished quote, a row whose length differs from the header's, or a last line
    /// without its line break.
    explicit CsvTable(std::filesystem::path path);
    /// From a file's bytes that were read by other means.
    CsvTable(std::filesystem::path path, std::string bytes);

    const std::vector<std::string>& header() const { return header_; }
    size_t row_count() const { return rows_.size(); }
    /// Throws for a column that isn't there.
    const std::string& text(size_t row, std::string_view column) const;
    /// Also throws for a field that is no number ("nan" and "inf" are).
    double number(size_t row, std::string_view column) const;

private:
    size_t index_of(std::string_view column) const;

    std::filesystem::path path_;
    std::vector<std::string> header_;
    std::vector<std::vector<std::string>> rows_;
    std::vector<size_t> lines_;  ///< of each row in the file, from 1
};

}  // namespace radiafit::harness
