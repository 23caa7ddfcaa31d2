#include "comparison_part.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/read_file.h"
#include "page/html_table.h"
#include "pieces.h"
#include "report/comparison.h"

namespace radiafit::harness {
namespace {

namespace fs = std::filesystem;

/// What is a reason to look; empty if nothing is.
Html differences(const Comparison& comparison) {
    Table table({"verdict", "file", "column", "figures", "at most, or why", "where"});
    for (const CellGroup& group : groups_of(comparison.cells, false)) {
        const Cell& worst = group.worst();
        if (is_worse(worst.verdict))
            table.add({to_string(worst.verdict), worst.file, fmt::format("{}", fmt::join(group.columns, ", ")),
                       std::to_string(group.cells.size()), figures_of(worst), group.where()});
    }
    if (table.rows().empty()) return {};
    const RunRecord &a = comparison.runs.before.front(), &b = comparison.runs.after.front();
    Html inside =
        element("summary", fmt::format("{} ({}): what is different, slower or missing", a.experiment, a.profile));
    inside << element("p", fmt::format("{}, then {}", name_of(a), name_of(b)));
    for (const std::string& apart : comparison.apart) inside << element("p", apart);
    inside << scroll_box(fmt::format("{}, compared", a.experiment), html_table({}, table));
    return element("details", inside);
}

Html compared(Pairing pairing) {
    Table table({"experiment", "profile", "before", "after", "figures"});
    Html details;
    for (RunPair& pair : pairing.pairs) {
        const RunRecord a = pair.before.front(), b = pair.after.front();
        try {
            const Comparison comparison = compare(std::move(pair));
            table.add({a.experiment, b.profile, name_of(a), name_of(b), text_of(comparison.counts)});
            details << differences(comparison);
        } catch (const UserError& e) {
            table.add({a.experiment, b.profile, name_of(a), name_of(b), e.what()});
        }
    }
    Html part = scroll_box("runs compared", html_table({}, table));
    for (const auto& [names, where] :
         {std::pair(&pairing.only_before, "the reference"), {&pairing.only_after, "the results"}})
        if (!names->empty()) part << element("p", fmt::format("Only in {}: {}.", where, fmt::join(*names, "; ")));
    return part << details;
}

}  // namespace

Html comparison_part(const RunFolders& folders) {
    Html part =
        element("p", Html("The newest runs against those that came with the checkout, figure by figure; the same as ")
                         << command_line("make compare") << " (docs/compare.md).");
    if (fs::weakly_canonical(folders.results) == fs::weakly_canonical(folders.reference))
        return part << not_run("the runs shown here are the reference itself");
    try {
        Pairing pairing = pair_runs(find_runs(folders.reference), find_runs(folders.results));
        if (!pairing.pairs.empty()) return part << compared(std::move(pairing));
        return part << not_run("no experiment has runs in both; make experiments");
    } catch (const UserError& e) {
        return part << not_run(e.what());
    }
}

}  // namespace radiafit::harness
