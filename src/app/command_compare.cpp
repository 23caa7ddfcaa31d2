// compare: two runs of an experiment, or two folders of runs, side by side.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "app/commands.h"
#include "base/error.h"
#include "base/log.h"
#include "report/compare.h"
#include "report/table.h"

namespace radiafit {
namespace {

using Json = nlohmann::ordered_json;
using Counts = std::map<Verdict, size_t>;

struct Comparison {
    RunPair runs;
    std::vector<std::string> apart;
    std::vector<Cell> cells;
};

/// Cells of one file with the same verdict, told in one line: of one column, or without figures of theirs.
struct Group {
    std::vector<const Cell*> cells;
    std::vector<std::string> columns;
    const Cell* worst() const {
        return *std::ranges::max_element(
            cells, {}, [](const Cell* c) { return c->interval ? std::abs(std::log(c->amount)) : c->amount; });
    }
};

bool has_figures(const Cell& cell) { return !cell.column.empty() && cell.reason.empty() && cell.rule; }

/// Worst verdicts first, then as the files have them.
std::vector<Group> groups_of(const std::vector<Cell>& cells, bool all) {
    std::map<std::tuple<Verdict, std::string, std::string, std::string>, size_t> places;
    std::vector<Group> groups;
    for (const Cell& cell : cells) {
        if (cell.verdict == Verdict::same && !all) continue;
        const auto [place, fresh] = places.try_emplace(
            {cell.verdict, cell.file, has_figures(cell) ? cell.column : "", cell.reason}, groups.size());
        if (fresh) groups.emplace_back();
        Group& group = groups[place->second];
        group.cells.push_back(&cell);
        if (std::ranges::count(group.columns, cell.column) == 0) group.columns.push_back(cell.column);
    }
    std::ranges::stable_sort(groups, {}, [](const Group& group) { return group.cells[0]->verdict; });
    return groups;
}

/// "27.6355, then 27.5012: 0.134 dB"; "1.23 times (1.18 to 1.29)"; or why nothing is said.
std::string figures_of(const Cell& cell) {
    if (!has_figures(cell)) return cell.reason;
    if (cell.interval)
        return fmt::format("{:.3g} times ({:.3g} to {:.3g})", cell.amount, cell.interval->low, cell.interval->high);
    if (cell.before == cell.after) return cell.before;
    std::string by;
    if (cell.amount > 0 && cell.amount < HUGE_VAL) {
        if (cell.rule->kind == ColumnKind::iterations)
            by = fmt::format(": {:g} iterations", cell.amount);
        else if (cell.rule->kind == ColumnKind::absolute)
            by = fmt::format(": {:.3g} {}", cell.amount, cell.rule->unit);
        else
            by = fmt::format(": {:.3g} %", 100 * cell.amount);
    }
    while (by.ends_with(' ')) by.pop_back();
    return fmt::format("{}, then {}{}", cell.before.empty() ? "nothing" : cell.before,
                       cell.after.empty() ? "nothing" : cell.after, by);
}

std::string name_of(const RunRecord& run) { return fmt::format("{} of {}", run.revision, run.utc); }

/// "2 DIFFERENT, 40 SAME".
std::string text_of(const Counts& counts) {
    std::vector<std::string> parts;
    for (const auto& [verdict, count] : counts) parts.push_back(fmt::format("{} {}", count, to_string(verdict)));
    return fmt::format("{}", fmt::join(parts, ", "));
}

Counts counts_of(const std::vector<Cell>& cells) {
    Counts counts;
    for (const Cell& cell : cells) ++counts[cell.verdict];
    return counts;
}

void print(const Comparison& comparison, bool all) {
    const RunRecord &a = comparison.runs.before.front(), &b = comparison.runs.after.front();
    fmt::print("{}: {}, then {}: {}\n", a.experiment, name_of(a), name_of(b), text_of(counts_of(comparison.cells)));
    for (const std::string& difference : comparison.apart) fmt::print("  {}\n", difference);
    Table table({"verdict", "file", "column", "figures", "at most, or why", "where"});
    const std::vector<Group> groups = groups_of(comparison.cells, all);
    for (const Group& group : groups) {
        const Cell& worst = *group.worst();
        const bool one = group.cells.size() == 1 || worst.reason.empty();  // a reason is that of all
        table.add({to_string(worst.verdict), worst.file, fmt::format("{}", fmt::join(group.columns, ", ")),
                   std::to_string(group.cells.size()), figures_of(worst), one ? worst.row : ""});
    }
    if (!groups.empty()) fmt::print("\n{}\n", table.text());
}

Json json_of(const std::vector<RunRecord>& runs) {
    const RunRecord& run = runs.front();
    return {{"folder", run.folder.string()}, {"revision", run.revision}, {"utc", run.utc},
            {"device", run.device()},        {"profile", run.profile},   {"runs", runs.size()}};
}

Json json_of(const Cell& cell) {
    Json json = {{"verdict", to_string(cell.verdict)}, {"file", cell.file}};
    if (!cell.row.empty()) json["row"] = cell.row;
    if (!cell.column.empty()) json["column"] = cell.column;
    if (cell.rule) {
        json["before"] = cell.before;
        json["after"] = cell.after;
        json[cell.rule->kind == ColumnKind::time ? "ratio" : "difference"] = cell.amount;
    }
    if (cell.interval) json["interval"] = {cell.interval->low, cell.interval->high};
    if (!cell.reason.empty()) json["reason"] = cell.reason;
    return json;
}

Json json_of(const Counts& counts) {
    Json json = Json::object();
    for (const auto& [verdict, count] : counts) json[to_string(verdict)] = count;
    return json;
}

void print_json(const std::vector<Comparison>& all_of_them, const Pairing& pairing, const Counts& total, bool all) {
    Json json = {{"format", "radiafit-comparison"}, {"version", 1}, {"verdicts", json_of(total)}};
    json["comparisons"] = Json::array();
    for (const Comparison& c : all_of_them) {
        Json cells = Json::array();
        for (const Cell& cell : c.cells)
            if (all || cell.verdict != Verdict::same) cells.push_back(json_of(cell));
        json["comparisons"].push_back({{"experiment", c.runs.before.front().experiment},
                                       {"before", json_of(c.runs.before)},
                                       {"after", json_of(c.runs.after)},
                                       {"apart", c.apart},
                                       {"verdicts", json_of(counts_of(c.cells))},
                                       {"figures", std::move(cells)}});
    }
    json["only_before"] = pairing.only_before;
    json["only_after"] = pairing.only_after;
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

struct Options {
    std::string before, after, only;
    bool all = false, json = false;
};

int compare(const Options& o) {
    Pairing pairing = pair_runs(find_runs(o.before), find_runs(o.after), o.only);
    if (pairing.pairs.empty())
        throw UserError(
            fmt::format("{} and {}: no experiment{} has runs in both; the first holds {}, the second {}", o.before,
                        o.after, o.only.empty() ? "" : fmt::format(" named like '{}'", o.only),
                        pairing.only_before.empty() ? "none" : fmt::format("{}", fmt::join(pairing.only_before, ", ")),
                        pairing.only_after.empty() ? "none" : fmt::format("{}", fmt::join(pairing.only_after, ", "))));
    std::vector<Comparison> comparisons;
    Counts total;
    for (RunPair& pair : pairing.pairs) {
        Comparison c{std::move(pair), {}, {}};
        c.apart = what_sets_apart(c.runs);
        c.cells = compare_runs(c.runs);
        for (const auto& [verdict, count] : counts_of(c.cells)) total[verdict] += count;
        comparisons.push_back(std::move(c));
    }
    if (o.json) {
        print_json(comparisons, pairing, total, o.all);
    } else {
        for (const Comparison& c : comparisons) print(c, o.all);
        for (const auto& [names, folder] :
             {std::pair(&pairing.only_before, &o.before), {&pairing.only_after, &o.after}})
            if (!names->empty()) fmt::print("only in {}: {}\n", *folder, fmt::join(*names, "; "));
        fmt::print("in all: {}\n", text_of(total));
    }
    return std::ranges::any_of(total, [](const auto& entry) { return is_worse(entry.first); }) ? 1 : 0;
}

}  // namespace

void add_compare(CommandLine& program, int& status) {
    auto o = std::make_shared<Options>();
    CommandLine& command =
        program.add_command("compare", "two runs of an experiment, or two folders of runs: what differs");
    command.add_text("before", o->before, "folder of a run, or of several").required();
    command.add_text("after", o->after, "likewise: what is held against it").required();
    command.add_word("--only", o->only, "experiments whose names contain this");
    command.add_flag("--all", o->all, "what is the same, too");
    add_json(command, o->json);
    command.on_run([=, &status] { status = compare(*o); });
}

}  // namespace radiafit
