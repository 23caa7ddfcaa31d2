#include "report/compare.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "base/error.h"
#include "report/csv.h"
#include "report/row_files.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

using Key = std::vector<std::string>;

constexpr double same_within = 1.02;  ///< times whose ratio surely lies below are the same
constexpr size_t fewest_values = 3, enough_values = 5;

std::string shown(const Key& key) {
    Key told;
    std::ranges::copy_if(key, std::back_inserter(told), [](const std::string& text) { return !text.empty(); });
    return fmt::format("{}", fmt::join(told, ", "));
}

/// The rows of one file of a run by their keys.
class Rows {
public:
    Rows(const RunRecord& run, const std::string& name, const TableRules& rules)
        : file_(run.folder / name), table_(read_rows(run, name)) {
        std::set<std::string> seen;
        bool repeated = false;
        for (const std::string& column : table_.header()) {
            const ColumnRule* rule = rules.rule(column);
            if (!rule)
                throw UserError(fmt::format("{}: column '{}' of {} has no rule; say what it is in {}", file_.string(),
                                            column, run.experiment, columns_file));
            if (!seen.insert(column).second)
                throw UserError(fmt::format("{}: column '{}' stands twice; remake the file", file_.string(), column));
            repeated = repeated || rule->kind == ColumnKind::repetition;
        }
        for (const auto& [column, rule] : rules.columns())  // in one order, whatever the file's is
            if ((rule.kind == ColumnKind::key || rule.kind == ColumnKind::device) && seen.contains(std::string(column)))
                keys_.emplace_back(column, &rule);
        if (keys_.empty()) return;  // nothing of it is compared
        for (size_t row = 0; row < table_.row_count(); ++row) {
            const Key key = key_of(row);
            std::vector<size_t>& rows = rows_[key];
            if (rows.empty()) order_.push_back(key);
            rows.push_back(row);
            if (rows.size() > 1 && !repeated)
                throw UserError(fmt::format("{}: two rows of '{}'; remake the file", file_.string(), shown(key)));
        }
    }

    const fs::path& file() const { return file_; }
    const CsvTable& table() const { return table_; }
    const std::vector<Key>& order() const { return order_; }  ///< keys, as their first rows stand in the file
    bool has(const std::string& column) const { return std::ranges::count(table_.header(), column) > 0; }
    /// Rows with this key; none if there are none.
    std::span<const size_t> rows(const Key& key) const {
        const auto found = rows_.find(key);
        return found == rows_.end() ? std::span<const size_t>() : found->second;
    }
    /// Throws UserError unless rows have the same keys as the other's.
    void require_keys_of(const Rows& other) const {
        for (const auto& [column, rule] : other.keys_)
            if (!has(column))
                throw UserError(
                    fmt::format("{}: no column '{}', by which rows of {} are told apart; run the experiment again",
                                file_.string(), column, other.file_.string()));
    }

private:
    Key key_of(size_t row) const {
        Key key;
        for (const auto& [column, rule] : keys_) {
            const std::string& text = table_.text(row, column);
            key.push_back(rule->kind == ColumnKind::key ? text : text.starts_with("cpu") ? "cpu" : "OpenGL");
        }
        return key;
    }

    fs::path file_;
    CsvTable table_;
    std::vector<std::pair<std::string, const ColumnRule*>> keys_;
    std::map<Key, std::vector<size_t>> rows_;
    std::vector<Key> order_;
};

/// How far apart two numbers are, as the rule measures it; infinite where one is no number, or says "never".
double distance(const ColumnRule& rule, double a, double b) {
    const bool relative =
        rule.kind == ColumnKind::relative || rule.kind == ColumnKind::exact || rule.kind == ColumnKind::memory;
    double d = std::abs(a - b);
    if (relative && d > 0) d /= std::max(std::abs(a), std::abs(b));
    if (rule.kind == ColumnKind::iterations && std::signbit(a) != std::signbit(b)) d = HUGE_VAL;
    return std::isnan(d) ? HUGE_VAL : d;
}

bool is_number(const std::string& text) {
    return !text.empty() && text.find_first_not_of("+-.0123456789eE") == std::string::npos;
}

/// One file of two runs.
class TableComparison {
public:
    /// Of each side the newest run's rows, then those of runs that repeat it. `apart`: why times can't be compared.
    TableComparison(const TableRules& rules, std::string name, const std::vector<Rows>& before,
                    const std::vector<Rows>& after, std::string apart)
        : rules_(rules), name_(std::move(name)), before_(before), after_(after), apart_(std::move(apart)) {}

    std::vector<Cell> cells() {
        const Rows &a = before_.front(), &b = after_.front();
        a.require_keys_of(b);
        b.require_keys_of(a);
        for (const std::string& column : a.table().header())
            if (!b.has(column)) add({.file = name_, .column = column, .row = "", .verdict = Verdict::missing});
        for (const std::string& column : b.table().header())
            if (!a.has(column)) add({.file = name_, .column = column, .row = "", .verdict = Verdict::added});
        for (const Key& key : a.order()) {
            if (!b.rows(key).empty())
                compare_row(key);
            else if (!rules_.partial())
                add({.file = name_, .column = "", .row = shown(key), .verdict = Verdict::missing});
        }
        for (const Key& key : b.order())
            if (a.rows(key).empty() && !rules_.partial())
                add({.file = name_, .column = "", .row = shown(key), .verdict = Verdict::added});
        return std::move(cells_);
    }

private:
    void add(Cell cell) { cells_.push_back(std::move(cell)); }

    void compare_row(const Key& key) {
        const Rows &a = before_.front(), &b = after_.front();
        if (const std::string other = other_work(b, key); !other.empty()) {
            add({.file = name_, .column = "", .row = shown(key), .verdict = Verdict::unclear, .reason = other});
            return;
        }
        for (const std::string& column : a.table().header()) {
            const ColumnRule& rule = *rules_.rule(column);
            if (!b.has(column)) continue;
            if (rule.kind == ColumnKind::time)
                compare_times(key, column, rule);
            else if (is_accuracy(rule))
                for (size_t i = 0; i < std::min(a.rows(key).size(), b.rows(key).size()); ++i)
                    compare_figures(key, column, rule, a.rows(key)[i], b.rows(key)[i]);
        }
    }

    static bool is_accuracy(const ColumnRule& rule) {
        switch (rule.kind) {
            case ColumnKind::exact:
            case ColumnKind::absolute:
            case ColumnKind::relative:
            case ColumnKind::iterations:
            case ColumnKind::memory:
                return true;
            default:
                return false;
        }
    }

    /// How another run's row is of more or less than that of the newest run before; empty if it isn't.
    std::string other_work(const Rows& other, const Key& key) const {
        const Rows& a = before_.front();
        for (const std::string& column : a.table().header()) {
            if (rules_.rule(column)->kind != ColumnKind::work || !other.has(column)) continue;
            const std::string &ours = a.table().text(a.rows(key)[0], column),
                              &theirs = other.table().text(other.rows(key)[0], column);
            if (ours != theirs) return fmt::format("of other {}", column);
        }
        return "";
    }

    void compare_figures(const Key& key, const std::string& column, const ColumnRule& rule, size_t row_a,
                         size_t row_b) {
        const CsvTable &a = before_.front().table(), &b = after_.front().table();
        Cell cell{.file = name_, .column = column, .row = shown(key), .rule = &rule};
        cell.before = a.text(row_a, column);
        cell.after = b.text(row_b, column);
        if (cell.before != cell.after) {
            const bool words = rule.kind == ColumnKind::exact && !(is_number(cell.before) && is_number(cell.after));
            cell.amount = words || cell.before.empty() || cell.after.empty()
                              ? HUGE_VAL
                              : distance(rule, a.number(row_a, column), b.number(row_b, column));
            // what is written with so many digits differs by a unit of the last one, and by its rounding in binary
            if (!(cell.amount <= rule.tolerance * (1 + 1e-6))) cell.verdict = Verdict::different;
        }
        add(std::move(cell));
    }

    void compare_times(const Key& key, const std::string& column, const ColumnRule& rule) {
        Cell cell{.file = name_, .column = column, .row = shown(key), .rule = &rule};
        const bool by_runs = std::min(before_.size(), after_.size()) >= fewest_values;
        const std::vector<double> a = timings(before_, key, column, by_runs), b = timings(after_, key, column, by_runs);
        cell.before = fmt::format("{:.6g}", median(a));
        cell.after = fmt::format("{:.6g}", median(b));
        if (apart_.empty()) {
            const TimeJudgement judged = judge_times(a, b);
            cell.verdict = judged.verdict;
            cell.amount = judged.ratio;
            cell.interval = judged.interval;
            cell.reason = judged.reason;
        } else {
            cell.verdict = Verdict::unclear;
            cell.reason = apart_;
        }
        add(std::move(cell));
    }

    /// By runs: one median for each run that has the row; else the newest run's repetitions.
    std::vector<double> timings(const std::vector<Rows>& runs, const Key& key, const std::string& column,
                                bool by_runs) const {
        std::vector<double> medians;
        for (const Rows& run : runs) {
            if (run.rows(key).empty() || !run.has(column) || !other_work(run, key).empty()) continue;
            std::vector<double> repetitions;
            for (const size_t row : run.rows(key)) repetitions.push_back(run.table().number(row, column));
            if (!by_runs) return repetitions;
            medians.push_back(median(std::move(repetitions)));
        }
        return medians;
    }

    const TableRules& rules_;
    std::string name_;
    const std::vector<Rows>&before_, &after_;
    std::string apart_;
    std::vector<Cell> cells_;
};

std::set<std::string> files_of(const RunRecord& run) {
    std::set<std::string> names;
    for (const std::string& name : run_files(run.folder))
        if (name.ends_with(".csv")) names.insert(name);
    return names;
}

/// This file of each run that has it.
std::vector<Rows> rows_of(const std::vector<RunRecord>& runs, const std::string& name, const TableRules& rules) {
    std::vector<Rows> rows;
    for (const RunRecord& run : runs)
        if (has_run_file(run, name)) rows.emplace_back(run, name, rules);
    return rows;
}

std::string device_and_profile(const RunRecord& run) { return fmt::format("{}, {}", run.profile, run.device()); }

/// The newest run of each device and profile, and all that repeat it, newest first.
std::vector<std::vector<RunRecord>> groups_of(std::span<const RunRecord> runs, const std::string& experiment) {
    std::vector<std::vector<RunRecord>> groups;
    for (const RunRecord& run : runs) {
        if (run.experiment != experiment) continue;
        const auto found = std::ranges::find(groups, device_and_profile(run),
                                             [](const auto& group) { return device_and_profile(group.front()); });
        if (found == groups.end())
            groups.push_back({run});
        else if (found->front().repeats(run))
            found->push_back(run);
    }
    return groups;
}

}  // namespace

const char* to_string(Verdict verdict) {
    constexpr std::array names = {"DIFFERENT", "SLOWER", "MISSING", "NEW", "FASTER", "UNCLEAR", "SAME"};
    return names[size_t(verdict)];
}

bool is_worse(Verdict verdict) {
    return verdict == Verdict::different || verdict == Verdict::slower || verdict == Verdict::missing;
}

Pairing pair_runs(std::span<const RunRecord> before, std::span<const RunRecord> after, const std::string& only) {
    std::set<std::string> experiments;
    for (const auto& side : {before, after})
        for (const RunRecord& run : side)
            if (run.experiment.find(only) != std::string::npos) experiments.insert(run.experiment);
    Pairing out;
    for (const std::string& experiment : experiments) {
        std::vector<std::vector<RunRecord>> a = groups_of(before, experiment), b = groups_of(after, experiment);
        const size_t pairs = out.pairs.size();
        for (auto at = a.begin(); at != a.end();) {
            const auto partner = std::ranges::find(b, device_and_profile(at->front()),
                                                   [](const auto& group) { return device_and_profile(group.front()); });
            if (partner == b.end()) {
                ++at;
                continue;
            }
            out.pairs.push_back({std::move(*at), std::move(*partner)});
            at = a.erase(at);
            b.erase(partner);
        }
        if (out.pairs.size() == pairs && !a.empty() && !b.empty()) {
            out.pairs.push_back({std::move(a.front()), std::move(b.front())});
            a.erase(a.begin());
            b.erase(b.begin());
        }
        for (auto [groups, names] : {std::pair(&a, &out.only_before), std::pair(&b, &out.only_after)})
            for (const auto& group : *groups)
                names->push_back(fmt::format("{} ({})", experiment, device_and_profile(group.front())));
    }
    return out;
}

std::vector<std::string> what_sets_apart(const RunPair& pair) {
    const RunRecord &a = pair.before.front(), &b = pair.after.front();
    std::vector<std::string> out;
    const auto note = [&](const char* what, const std::string& before, const std::string& after) {
        if (before != after) out.push_back(fmt::format("{}: {}, then {}", what, before, after));
    };
    note("device", a.device(), b.device());
    note("profile", a.profile, b.profile);
    std::set<std::string> keys;
    for (const RunRecord* run : {&a, &b})
        for (const auto& [key, value] : run->config) keys.insert(key);
    const auto value = [](const RunRecord& run, const std::string& key) {
        const auto found = run.config.find(key);
        return found == run.config.end() ? "not there" : found->second;
    };
    for (const std::string& key : keys) note(("config, " + key).c_str(), value(a, key), value(b, key));
    return out;
}

std::vector<Cell> compare_runs(const RunPair& pair) {
    const RunRecord &a = pair.before.front(), &b = pair.after.front();
    const std::vector<std::string> differences = what_sets_apart(pair);
    const std::string apart =
        differences.empty() ? ""
                            : "of another " + differences.front().substr(0, differences.front().find_first_of(":,"));
    std::set<std::string> names = files_of(a);
    names.merge(files_of(b));
    std::vector<Cell> cells;
    for (const std::string& name : names) {
        const TableRules* rules = find_table_rules(a.experiment, name);
        if (!rules)
            throw UserError(fmt::format("{}: no rules for this file of {}; say what its columns are in {}",
                                        ((has_run_file(a, name) ? a : b).folder / name).string(), a.experiment,
                                        columns_file));
        const bool here = has_run_file(a, name), there = has_run_file(b, name);
        // read in any case, so that a damaged file is told
        const std::vector<Rows> before = rows_of(pair.before, name, *rules), after = rows_of(pair.after, name, *rules);
        if (here != there) {
            cells.push_back(
                {.file = name, .column = "", .row = "", .verdict = here ? Verdict::missing : Verdict::added});
            continue;
        }
        std::ranges::move(TableComparison(*rules, name, before, after, apart).cells(), std::back_inserter(cells));
    }
    return cells;
}

TimeJudgement judge_times(const std::vector<double>& before, const std::vector<double>& after) {
    const auto all_zero = [](const std::vector<double>& v) {
        return std::ranges::all_of(v, [](double x) { return x == 0; });
    };
    const auto all_above_zero = [](const std::vector<double>& v) {
        return std::ranges::all_of(v, [](double x) { return x > 0 && x < HUGE_VAL; });
    };
    const size_t fewest = std::min(before.size(), after.size());
    if (fewest == 0) return {.verdict = Verdict::unclear, .reason = "no timing"};
    if (all_zero(before) && all_zero(after)) return {.verdict = Verdict::same, .ratio = 1};
    if (!all_above_zero(before) || !all_above_zero(after))
        return {.verdict = Verdict::unclear, .reason = "a timing that is not above 0"};
    TimeJudgement out{.verdict = Verdict::unclear, .ratio = median(after) / median(before)};
    if (fewest < fewest_values) {
        out.reason = fmt::format("{} and {} timings; it takes {} of each", before.size(), after.size(), fewest_values);
        return out;
    }
    if (fewest >= enough_values) {
        out.interval = ratio_of_medians(after, before);
    } else {  // too few to draw from: the two ranges must lie apart by more than the wider of them
        const auto [low_a, high_a] = std::ranges::minmax(before);
        const auto [low_b, high_b] = std::ranges::minmax(after);
        const double spread = std::max(high_a / low_a, high_b / low_b);
        out.interval = {low_b / high_a / spread, high_b / low_a * spread};
    }
    const auto [low, high] = *out.interval;
    if (low >= 1 / same_within && high <= same_within)
        out.verdict = Verdict::same;
    else if (low > 1)
        out.verdict = Verdict::slower;
    else if (high < 1)
        out.verdict = Verdict::faster;
    return out;
}

}  // namespace radiafit
