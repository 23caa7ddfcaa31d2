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
#include "report/experiments.h"
#include "report/keyed_rows.h"
#include "report/row_files.h"

namespace radiafit::harness {
namespace fs = std::filesystem;
namespace {

constexpr double same_within = 1.02;  ///< times whose ratio surely lies below are the same
constexpr size_t fewest_values = 3, enough_values = 5;

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
    /// Of each side the newest run's rows, then those of runs that repeat it; `united`: both sides repeat one another.
    /// `apart`: why times can't be compared.
    TableComparison(const RowFile& rules, std::string name, const std::vector<KeyedRows>& before,
                    const std::vector<KeyedRows>& after, bool united, std::string apart)
        : rules_(rules),
          name_(std::move(name)),
          before_(before),
          after_(after),
          apart_(std::move(apart)),
          united_(united) {
        for (const KeyedRows& rows : before) before_runs_.push_back(&rows);
        for (const KeyedRows& rows : after) after_runs_.push_back(&rows);
        same_programs_ = {before_runs_, after_runs_};
        if (united) same_programs_.front().insert(same_programs_.front().end(), after_runs_.begin(), after_runs_.end());
    }

    std::vector<Cell> cells() {
        const KeyedRows &a = before_.front(), &b = after_.front();
        a.require_keys_of(b);
        b.require_keys_of(a);
        for (const std::string& column : a.table().header())
            if (!b.has(column)) add({.file = name_, .column = column, .row = "", .verdict = Verdict::missing});
        for (const std::string& column : b.table().header())
            if (!a.has(column)) add({.file = name_, .column = column, .row = "", .verdict = Verdict::added});
        for (const RowKey& key : a.order()) {
            if (!b.rows(key).empty())
                compare_row(key);
            else if (!rules_.partial())
                add({.file = name_, .column = "", .row = shown(key), .verdict = Verdict::missing});
        }
        for (const RowKey& key : b.order())
            if (a.rows(key).empty() && !rules_.partial())
                add({.file = name_, .column = "", .row = shown(key), .verdict = Verdict::added});
        return std::move(cells_);
    }

private:
    using Runs = std::vector<const KeyedRows*>;

    void add(Cell cell) { cells_.push_back(std::move(cell)); }

    void compare_row(const RowKey& key) {
        const KeyedRows &a = before_.front(), &b = after_.front();
        const std::span<const size_t> rows_a = a.rows(key), rows_b = b.rows(key);
        if (const std::string other = other_work(rows_a[0], b, rows_b[0]); !other.empty()) {
            add({.file = name_, .column = "", .row = shown(key), .verdict = Verdict::unclear, .reason = other});
            return;
        }
        for (size_t i = 0; i < a.table().header().size(); ++i) {
            const std::string& column = a.table().header()[i];
            const ColumnRule& rule = a.rule(i);
            if (!b.has(column)) continue;
            if (rule.kind == ColumnKind::time)
                compare_times(key, column, rule);
            else if (is_accuracy(rule))
                for (size_t row = 0; row < std::min(rows_a.size(), rows_b.size()); ++row)
                    compare_figures(key, column, rule, rows_a[row], rows_b[row]);
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

    /// How another run's row is of more or less than one of the newest run before; empty if it isn't.
    std::string other_work(size_t row, const KeyedRows& other, size_t other_row) const {
        const KeyedRows& a = before_.front();
        for (size_t i = 0; i < a.table().header().size(); ++i) {
            const std::string& column = a.table().header()[i];
            if (a.rule(i).kind != ColumnKind::work || !other.has(column)) continue;
            const std::string &ours = a.table().text(row, column), &theirs = other.table().text(other_row, column);
            if (ours != theirs) return fmt::format("of other {}", column);
        }
        return "";
    }

    void compare_figures(const RowKey& key, const std::string& column, const ColumnRule& rule, size_t row_a,
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

    void compare_times(const RowKey& key, const std::string& column, const ColumnRule& rule) {
        Cell cell{.file = name_, .column = column, .row = shown(key), .rule = &rule};
        const bool by_runs = std::min(before_.size(), after_.size()) >= fewest_values;
        const auto timings_of = [&](const Runs& runs) {
            return by_runs ? medians_of(runs, key, column) : timings(*runs.front(), runs.front()->rows(key), column);
        };
        const std::vector<double> a = timings_of(before_runs_), b = timings_of(after_runs_);
        cell.before = fmt::format("{:.6g}", median(a));
        cell.after = fmt::format("{:.6g}", median(b));
        if (apart_.empty()) {
            const TimeJudgement judged = judge_times(a, b, by_runs ? 1 : run_to_run(column));
            cell.verdict = judged.verdict;
            if (united_ && !by_runs && cell.verdict != Verdict::same) cell.verdict = Verdict::unclear;
            cell.amount = judged.ratio;
            cell.interval = judged.interval;
            cell.reason = judged.reason;
        } else {
            cell.verdict = Verdict::unclear;
            cell.reason = apart_;
        }
        add(std::move(cell));
    }

    /// The repetitions in one run's rows.
    static std::vector<double> timings(const KeyedRows& run, std::span<const size_t> rows, const std::string& column) {
        std::vector<double> repetitions;
        for (const size_t row : rows) repetitions.push_back(run.table().number(row, column));
        return repetitions;
    }

    /// One for each of the runs that has the row.
    std::vector<double> medians_of(const Runs& runs, const RowKey& key, const std::string& column) const {
        std::vector<double> medians;
        const size_t row = before_.front().rows(key)[0];
        for (const KeyedRows* run : runs) {
            const std::span<const size_t> rows = run->rows(key);
            if (!rows.empty() && run->has(column) && other_work(row, *run, rows[0]).empty())
                medians.push_back(median(timings(*run, rows, column)));
        }
        return medians;
    }

    /// By how much the column's times differ between runs of one program: the largest ratio of two runs' medians of a
    /// row. Nothing where no two runs repeat one another.
    std::optional<double> run_to_run(const std::string& column) {
        const auto [place, fresh] = noise_.try_emplace(column);
        if (!fresh) return place->second;
        for (const auto& runs : same_programs_)
            for (const RowKey& key : before_.front().order()) {
                const std::vector<double> medians = medians_of(runs, key, column);
                if (medians.size() < 2) continue;
                const auto [least, most] = std::ranges::minmax(medians);
                if (least > 0) place->second = std::max(place->second.value_or(1), most / least);
            }
        return place->second;
    }

    const RowFile& rules_;
    std::string name_;
    const std::vector<KeyedRows>&before_, &after_;
    std::string apart_;
    bool united_;
    Runs before_runs_, after_runs_;
    std::vector<Runs> same_programs_;                     ///< runs that repeat one another
    std::map<std::string, std::optional<double>> noise_;  ///< run_to_run() by column
    std::vector<Cell> cells_;
};

std::set<std::string> files_of(const RunRecord& run) {
    std::set<std::string> names;
    for (const std::string& name : run_files(run.folder))
        if (name.ends_with(".csv")) names.insert(name);
    return names;
}

/// This file of each run that has it.
std::vector<KeyedRows> rows_of(const std::vector<RunRecord>& runs, const std::string& name, const RowFile& rules) {
    std::vector<KeyedRows> rows;
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
        const RowFile* rules = find_row_file(a.experiment, name);
        if (!rules)
            throw UserError(fmt::format("{}: no rules for this file of {}; say what its columns are in {}",
                                        ((has_run_file(a, name) ? a : b).folder / name).string(), a.experiment,
                                        rows_folder));
        const bool here = has_run_file(a, name), there = has_run_file(b, name);
        // read in any case, so that a damaged file is reported
        const std::vector<KeyedRows> before = rows_of(pair.before, name, *rules),
                                     after = rows_of(pair.after, name, *rules);
        if (here != there) {
            cells.push_back(
                {.file = name, .column = "", .row = "", .verdict = here ? Verdict::missing : Verdict::added});
            continue;
        }
        std::ranges::move(TableComparison(*rules, name, before, after, a.repeats(b), apart).cells(),
                          std::back_inserter(cells));
    }
    return cells;
}

TimeJudgement judge_times(const std::vector<double>& before, const std::vector<double>& after,
                          std::optional<double> run_to_run) {
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
    if (!run_to_run) {
        out.reason = "no two runs of one program tell how much this time differs from run to run; repeat either side";
        return out;
    }
    out.interval = {out.interval->low / *run_to_run, out.interval->high * *run_to_run};
    const auto [low, high] = *out.interval;
    if (low >= 1 / same_within && high <= same_within)
        out.verdict = Verdict::same;
    else if (low > 1)
        out.verdict = Verdict::slower;
    else if (high < 1)
        out.verdict = Verdict::faster;
    return out;
}

}  // namespace radiafit::harness
