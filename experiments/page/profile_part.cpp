#include "profile_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"
#include "exhibits_part.h"
#include "page/html_table.h"
#include "page/performance_profile.h"
#include "pieces.h"
#include "report/csv.h"
#include "report/figures.h"
#include "report/row_files.h"

namespace radiafit::harness {
namespace {

namespace fs = std::filesystem;

constexpr const char* file = "vertices.csv";
constexpr double problems_of_vertex = 3;

/// The times of every solver, in the rows' order, on every vertex that any of them took.
std::vector<SolverTimes> times_of(const CsvTable& rows) {
    std::vector<SolverTimes> times;
    std::map<std::string, size_t> solvers, vertices;
    for (size_t i = 0; i < rows.row_count(); ++i) vertices.try_emplace(rows.text(i, "vertex"), vertices.size());
    for (size_t i = 0; i < rows.row_count(); ++i) {
        const std::string& setting = rows.text(i, "setting");
        const std::string solver = rows.text(i, "solver") + (setting.empty() ? "" : " " + setting);
        const auto [place, fresh] = solvers.try_emplace(solver, times.size());
        if (fresh) times.push_back({solver, std::vector<double>(vertices.size(), NAN)});
        const double seconds = rows.number(i, "seconds_to_101");
        if (!(seconds >= 0)) throw UserError(fmt::format("{}: a time below 0; run the experiment again", file));
        times[place->second].seconds[vertices.at(rows.text(i, "vertex"))] =
            rows.number(i, "reached") == problems_of_vertex ? seconds : INFINITY;
    }
    return times;
}

/// Steps of the curves, for the figure; all reach as far as the longest.
void write_curves(const std::vector<PerformanceProfile>& profiles, const fs::path& path) {
    double last = 1;
    for (const PerformanceProfile& profile : profiles)
        for (const double factor : profile.ratios)
            if (std::isfinite(factor)) last = std::max(last, factor);
    CsvWriter curves(path, {"curve", "solver", "tried", "factor", "share"});
    for (size_t i = 0; i < profiles.size(); ++i) {
        const auto step = [&](double factor) {
            curves.row({std::to_string(i + 1), profiles[i].solver, std::to_string(profiles[i].tried),
                        fmt::format("{:.6g}", factor), fmt::format("{:.6g}", profiles[i].share_within(factor))});
        };
        step(1);
        for (const double factor : profiles[i].ratios)
            if (std::isfinite(factor)) step(factor);
        step(last);
    }
    curves.commit();
}

Html table_of(const std::vector<PerformanceProfile>& profiles) {
    constexpr std::array factors = {1.0, 2.0, 5.0, 10.0, 100.0};
    std::vector<std::string> header = {"solver", "vertices tried", "fastest"};
    for (size_t i = 1; i < factors.size(); ++i) header.push_back(fmt::format("within {:g} times", factors[i]));
    header.emplace_back("solved");
    Table table(header);
    const auto percent = [](double share) { return fmt::format("{:.0f} %", 100 * share); };
    for (const PerformanceProfile& profile : profiles) {
        std::vector<std::string> fields = {profile.solver, std::to_string(profile.tried)};
        for (const double factor : factors) fields.push_back(percent(profile.share_within(factor)));
        fields.push_back(percent(profile.share_within(INFINITY)));
        table.add(std::move(fields));
    }
    return scroll_box("performance profile of the solvers",
                      html_table("Share of the vertices tried that each solver solved", table));
}

Html part_of(const RunFolders& folders, const RunRecord& run, const fs::path& scratch) {
    const std::string name = fs::relative(run.folder, folders.checkout).generic_string();
    if (!has_run_file(run, file))
        return not_run(fmt::format("{}: no {}, of an older version or lost; make experiments PROFILE={} ONLY=solvers",
                                   name, file, run.profile));
    try {
        std::vector<PerformanceProfile> profiles = performance_profiles(times_of(read_rows(run, file)));
        std::ranges::stable_sort(profiles, std::ranges::greater(), [](const auto& p) { return p.share_within(2); });
        fs::create_directories(scratch);
        write_curves(profiles, scratch / "profile.csv");
        draw_figure(folders.checkout / "paper_figs" / "performance_profile.gp", scratch / "profile",
                    {{"rows", scratch.string()}, {"caption", run.caption}});
        const Html caption = Html(run.caption)
                             << fmt::format(" ({} profile; ", run.profile) << element("code", name) << ")";
        const char* alt =
            "One rising step curve for each solver: across, on a logarithmic axis, the factor of the fastest solver's "
            "time; up, "
            "the share of vertices solved within it. The table below gives the same in numbers.";
        Html part = element("figure", scroll_box("performance profile", image(scratch / "profile", alt))
                                          << element("figcaption", caption));
        return part << table_of(profiles);
    } catch (const UserError& e) {  // damaged rows
        return not_run(e.what());
    }
}

}  // namespace

Html performance_part(const RunFolders& folders, const std::string& profile, const fs::path& scratch) {
    Html part = element(
        "p",
        "The share of problems (here vertices, whose three problems are solved together) that a solver solved to "
        "within 1 % of "
        "the best error of all solvers, within a factor of the fastest solver's processor time on the same problem "
        "(Dolan "
        "and Moré 2002). Where a curve begins, at the factor 1, it says how often the solver was the fastest; where it "
        "ends, "
        "how many problems it solves at all. Slow solvers had time for fewer vertices; their shares are of those.");
    const std::vector<RunRecord> runs = shown_runs(folders, "solvers", profile);
    if (runs.empty())
        return part << not_run(fmt::format("no solvers results; make experiments PROFILE={} ONLY=solvers", profile));
    std::string told;  // of each profile the newest
    for (size_t i = 0; i < runs.size(); ++i)
        if (runs[i].profile != told) {
            part << part_of(folders, runs[i], scratch / std::to_string(i));
            told = runs[i].profile;
        }
    return part;
}

}  // namespace radiafit::harness
