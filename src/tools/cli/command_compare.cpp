// compare: two runs of an experiment, or two folders of runs, side by side.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/log.h"
#include "cli/commands.h"
#include "report/comparison.h"
#include "report/result_archive.h"
#include "report/table.h"

namespace radiafit::tools {
namespace {

using Json = nlohmann::ordered_json;

void print(const Comparison& comparison, bool all) {
    const RunRecord &a = comparison.runs.before.front(), &b = comparison.runs.after.front();
    fmt::print("{}: {}, then {}: {}\n", a.experiment, name_of(a), name_of(b), text_of(comparison.counts));
    for (const std::string& difference : comparison.apart) fmt::print("  {}\n", difference);
    Table table({"verdict", "file", "column", "figures", "at most, or why", "where"});
    const std::vector<CellGroup> groups = groups_of(comparison.cells, all);
    for (const CellGroup& group : groups) {
        const Cell& worst = group.worst();
        table.add({to_string(worst.verdict), worst.file, fmt::format("{}", fmt::join(group.columns, ", ")),
                   std::to_string(group.cells.size()), figures_of(worst), group.where()});
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

Json json_of(const VerdictCounts& counts) {
    Json json = Json::object();
    for (const auto& [verdict, count] : counts) json[to_string(verdict)] = count;
    return json;
}

void print_json(const std::vector<Comparison>& all_of_them, const Pairing& pairing, const VerdictCounts& total,
                bool all) {
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
                                       {"verdicts", json_of(c.counts)},
                                       {"figures", std::move(cells)}});
    }
    json["only_before"] = pairing.only_before;
    json["only_after"] = pairing.only_after;
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

struct CompareOptions {
    std::string before, after, only;
    bool all = false, json = false;
};

int run_compare(const CompareOptions& o) {
    const UnpackedResults before(o.before), after(o.after);
    Pairing pairing = pair_runs(find_runs(before.folder()), find_runs(after.folder()), o.only);
    if (pairing.pairs.empty())
        throw UserError(
            fmt::format("{} and {}: no experiment{} has runs in both; the first holds {}, the second {}", o.before,
                        o.after, o.only.empty() ? "" : fmt::format(" named like '{}'", o.only),
                        pairing.only_before.empty() ? "none" : fmt::format("{}", fmt::join(pairing.only_before, ", ")),
                        pairing.only_after.empty() ? "none" : fmt::format("{}", fmt::join(pairing.only_after, ", "))));
    std::vector<Comparison> comparisons;
    VerdictCounts total;
    for (RunPair& pair : pairing.pairs) {
        comparisons.push_back(compare(std::move(pair)));
        for (const auto& [verdict, count] : comparisons.back().counts) total[verdict] += count;
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
    auto o = std::make_shared<CompareOptions>();
    CommandLine& command =
        program.add_command("compare", "two runs of an experiment, or two folders of runs: what differs");
    command
        .add_text("before", o->before, "folder of a run or of several, or an archive that radiafit-bench --all wrote")
        .required();
    command.add_text("after", o->after, "likewise: what is held against it").required();
    command.add_word("--only", o->only, "experiments whose names contain this");
    command.add_flag("--all", o->all, "what is the same, too");
    add_json(command, o->json);
    command.on_run([=, &status] { status = run_compare(*o); });
}

}  // namespace radiafit::tools
