#pragma once
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "report/columns.h"
#include "report/csv.h"
#include "report/finished_runs.h"

namespace radiafit::harness {

/// Texts of a row's key columns, as the rules have them; a device's is "cpu" or "OpenGL".
using RowKey = std::vector<std::string>;
/// "star, cpu-low, 1".
std::string shown(const RowKey& key);

/// The rows of one file of a run by their keys.
class KeyedRows {
public:
    /// Throws UserError, naming the file: for columns without a rule, columns that occur twice, and rows with the same
    /// keys which are no repetitions.
    KeyedRows(const RunRecord& run, const std::string& name, const RowFile& rules);

    const CsvTable& table() const { return table_; }
    const std::vector<RowKey>& order() const { return order_; }  ///< keys, in the order of their first rows in the file
    bool has(const std::string& column) const;
    /// Of a column, by its place in the header.
    const ColumnRule& rule(size_t column) const { return *column_rules_[column]; }
    /// Rows with this key; none if there are none.
    std::span<const size_t> rows(const RowKey& key) const;
    /// Throws UserError unless rows have the same keys as the other's.
    void require_keys_of(const KeyedRows& other) const;

private:
    RowKey key_of(size_t row) const;

    std::filesystem::path file_;
    CsvTable table_;
    std::vector<const ColumnRule*> column_rules_;
    std::vector<std::pair<std::string, const ColumnRule*>> keys_;
    std::map<RowKey, std::vector<size_t>> rows_;
    std::vector<RowKey> order_;
};

}  // namespace radiafit::harness
