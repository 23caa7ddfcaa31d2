#include "report/comparison.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace radiafit::harness {
namespace {

bool has_figures(const Cell& cell) { return !cell.column.empty() && cell.reason.empty() && cell.rule; }

}  // namespace

Comparison compare(RunPair runs) {
    Comparison comparison{std::move(runs), {}, {}, {}};
    comparison.apart = what_sets_apart(comparison.runs);
    comparison.cells = compare_runs(comparison.runs);
    for (const Cell& cell : comparison.cells) ++comparison.counts[cell.verdict];
    return comparison;
}

const Cell& CellGroup::worst() const {
    return **std::ranges::max_element(
        cells, {}, [](const Cell* c) { return c->interval ? std::abs(std::log(c->amount)) : c->amount; });
}

std::string CellGroup::where() const {
    const bool one = cells.size() == 1 || worst().reason.empty();
    return one ? worst().row : "";
}

std::vector<CellGroup> groups_of(const std::vector<Cell>& cells, bool all) {
    std::map<std::tuple<Verdict, std::string, std::string, std::string>, size_t> places;
    std::vector<CellGroup> groups;
    for (const Cell& cell : cells) {
        if (cell.verdict == Verdict::same && !all) continue;
        const auto [place, fresh] = places.try_emplace(
            {cell.verdict, cell.file, has_figures(cell) ? cell.column : "", cell.reason}, groups.size());
        if (fresh) groups.emplace_back();
        CellGroup& group = groups[place->second];
        group.cells.push_back(&cell);
        if (std::ranges::count(group.columns, cell.column) == 0) group.columns.push_back(cell.column);
    }
    std::ranges::stable_sort(groups, {}, [](const CellGroup& group) { return group.cells[0]->verdict; });
    return groups;
}

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

std::string text_of(const VerdictCounts& counts) {
    std::vector<std::string> parts;
    for (const auto& [verdict, count] : counts) parts.push_back(fmt::format("{} {}", count, to_string(verdict)));
    return fmt::format("{}", fmt::join(parts, ", "));
}

std::string name_of(const RunRecord& run) { return fmt::format("{} of {}", run.revision, run.utc); }

}  // namespace radiafit::harness
