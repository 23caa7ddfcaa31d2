#include "report/keyed_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "report/experiments.h"
#include "report/row_files.h"

namespace radiafit::harness {

std::string shown(const RowKey& key) {
    RowKey shown;
    std::ranges::copy_if(key, std::back_inserter(shown), [](const std::string& text) { return !text.empty(); });
    return fmt::format("{}", fmt::join(shown, ", "));
}

KeyedRows::KeyedRows(const RunRecord& run, const std::string& name, const RowFile& rules)
    : file_(run.folder / name), table_(read_rows(run, name)) {
    std::set<std::string> seen;
    bool repeated = false;
    for (const std::string& column : table_.header()) {
        const ColumnRule* rule = rules.rule(column);
        if (!rule)
            throw UserError(fmt::format("{}: column '{}' of {} has no rule; say what it is in {}", file_.string(),
                                        column, run.experiment, rows_folder));
        if (!seen.insert(column).second)
            throw UserError(fmt::format("{}: column '{}' appears twice; remake the file", file_.string(), column));
        repeated = repeated || rule->kind == ColumnKind::repetition;
        column_rules_.push_back(rule);
    }
    for (const Columns& group : rules.columns())  // in one order, whatever the file's is
        if (group.type.rule.kind == ColumnKind::key || group.type.rule.kind == ColumnKind::device)
            for (const std::string& column : group.names())
                if (seen.contains(column)) keys_.emplace_back(column, &group.type.rule);
    if (keys_.empty()) return;  // nothing of it is compared
    for (size_t row = 0; row < table_.row_count(); ++row) {
        const RowKey key = key_of(row);
        std::vector<size_t>& rows = rows_[key];
        if (rows.empty()) order_.push_back(key);
        rows.push_back(row);
        if (rows.size() > 1 && !repeated)
            throw UserError(fmt::format("{}: two rows of '{}'; remake the file", file_.string(), shown(key)));
    }
}

bool KeyedRows::has(const std::string& column) const { return std::ranges::count(table_.header(), column) > 0; }

std::span<const size_t> KeyedRows::rows(const RowKey& key) const {
    const auto found = rows_.find(key);
    return found == rows_.end() ? std::span<const size_t>() : found->second;
}

void KeyedRows::require_keys_of(const KeyedRows& other) const {
    for (const auto& [column, rule] : other.keys_)
        if (!has(column))
            throw UserError(
                fmt::format("{}: no column '{}', by which rows of {} are told apart; run the experiment again",
                            file_.string(), column, other.file_.string()));
}

RowKey KeyedRows::key_of(size_t row) const {
    RowKey key;
    for (const auto& [column, rule] : keys_) {
        const std::string& text = table_.text(row, column);
        key.push_back(rule->kind == ColumnKind::key ? text : text.starts_with("cpu") ? "cpu" : "OpenGL");
    }
    return key;
}

}  // namespace radiafit::harness
