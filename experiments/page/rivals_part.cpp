#include "page/rivals_part.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "base/error.h"
#include "exhibits_part.h"
#include "page/html_table.h"
#include "page/rivals.h"
#include "pieces.h"
#include "report/row_files.h"

namespace radiafit::harness {
namespace {

std::string spelled(const std::string& solver) {
    static constexpr std::array<std::pair<const char*, const char*>, 22> names = {{
        {"two-step cg modern", "modern CG, the default"},
        {"two-step cg paper", "the paper’s CG"},
        {"two-step sd", "the paper’s SD"},
        {"two-step lbfgs", "L-BFGS, ours"},
        {"two-step adam", "Adam, ours"},
        {"varpro", "variable projection"},
        {"varpro AVX2", "variable projection, AVX2"},
        {"varpro SSE2", "variable projection, SSE2"},
        {"als", "alternating least squares"},
        {"ceres lbfgs", "Ceres’ L-BFGS"},
        {"ceres nonlinear-cg", "Ceres’ nonlinear CG"},
        {"LM", "Levenberg–Marquardt, the default"},
        {"LM, AVX2", "Levenberg–Marquardt, AVX2"},
        {"LM, SSE2", "Levenberg–Marquardt, SSE2"},
        {"Ceres", "Ceres’ Levenberg–Marquardt"},
        {"Ceres varpro", "variable projection given to Ceres"},
        {"TinySolver", "Ceres’ TinySolver"},
        {"TinySolver in floats", "Ceres’ TinySolver in floats"},
        {"cg modern", "modern CG"},
        {"cg paper", "the paper’s CG"},
        {"lbfgs", "L-BFGS, ours"},
        {"adam", "Adam, ours"},
    }};
    for (const auto& [name, text] : names)
        if (solver == name) return text;
    return solver;
}

Html table_of(const std::string& caption, const std::vector<Rival>& rivals, double unit) {
    std::vector<std::string> header = {"solver"};
    for (const double share : rival_shares) header.push_back(fmt::format("{:g} % arrive", 100 * share));
    for (const char* what : {"arrive at all", "of", "bits", "side by side", "instructions"}) header.emplace_back(what);
    Table table(header);
    for (const Rival& rival : rivals) {
        std::vector<std::string> fields = {spelled(rival.solver)};
        for (const auto& seconds : rival.seconds)
            fields.push_back(seconds ? fmt::format("{:.3g}", *seconds / unit) : "never");
        fields.push_back(fmt::format("{:.1f} %", 100 * rival.arrived));
        fields.push_back(std::to_string(rival.problems));
        fields.push_back(rival.precision);
        fields.push_back(std::to_string(rival.together));
        fields.push_back(rival.instructions);
        table.add(std::move(fields));
    }
    return scroll_box(caption, html_table(caption, table));
}

/// Of the newest run of an experiment that has what `table` asks for.
template <class MakeTable>
Html part_of(const RunFolders& folders, const std::string& profile, const char* experiment, const char* file,
             const MakeTable& table) {
    for (const RunRecord& run : shown_runs(folders, experiment, profile)) {
        if (!has_run_file(run, file)) continue;
        try {
            return table(run) << element(
                       "p", {{"class", "source"}},
                       Html(fmt::format("{}, {} profile; ", run.caption, run.profile)) << element(
                           "code", std::filesystem::relative(run.folder, folders.checkout).generic_string()));
        } catch (const UserError&) {  // rows of an older version
        }
    }
    return not_run(
        fmt::format("no {} with equal shares; make experiments PROFILE={} ONLY={}", experiment, profile, experiment));
}

}  // namespace

Html rivals_part(const RunFolders& folders, const std::string& profile) {
    Html part = element(
        "p",
        "Times of one thread at equal shares of problems that arrive, which is to come within 1 % of the least error "
        "that any solver found: at each solver’s own share they could not be compared. Side by side is how many "
        "problems a register holds. A ratio of two times is the algorithm’s and the engineering’s at once. Whoever "
        "brings less than half home is left out.");
    part << part_of(folders, profile, "solvers", "vertices.csv", [&](const RunRecord& run) {
        const std::vector<Rival> rivals = vertex_rivals(read_rows(run, "vertices.csv"), read_rows(run, "solvers.csv"));
        return table_of(
            "Light field maps: milliseconds within which so many vertices have arrived, each with all of its three "
            "channels; of Ceres’ settings the best",
            rivals, 1e-3);
    });
    const Html texels = part_of(folders, profile, "reflectance", "arrival.csv", [&](const RunRecord& run) {
        return table_of(
            "Microseconds for a texel of the noisy ornament, of fits by the fewest iterations tried that bring so many "
            "home",
            texel_rivals(read_rows(run, "arrival.csv")), 1e-6);
    });
    return part << element("details", element("summary", "Texels of Lafortune’s model, likewise") << texels);
}

}  // namespace radiafit::harness
