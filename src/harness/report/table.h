#pragma once
#include <string>
#include <vector>

#include "base/rings.h"

/// Rows for people to read. A column whose every field starts like a number is set to the right.
namespace radiafit::harness {

class Table {
public:
    explicit Table(std::vector<std::string> header) : header_(std::move(header)) {}
    /// As many fields as the header has, or std::logic_error. UTF-8; a character counts as one column.
    void add(std::vector<std::string> fields);
    const std::vector<std::string>& header() const { return header_; }
    const std::vector<std::vector<std::string>>& rows() const { return rows_; }
    /// Whether the column is set to the right.
    bool numeric(size_t column) const;

    /// Aligned with spaces, a rule under the header, no trailing blanks.
    std::string text() const;
    /// GitHub's pipe table, aligned in its source too.
    std::string markdown() const;

private:
    struct Column {
        size_t width;  ///< in characters
        bool right;
    };
    std::vector<Column> columns(const std::vector<std::vector<std::string>>& lines) const;

    std::vector<std::string> header_;
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace radiafit::harness
