// One page of everything that the experiments found: each claim with its verdict, every figure and table beside what
// the paper says of it, our solvers beside others', a performance profile, what differs from the reference, and with
// what it was all made. Nothing is measured here: claims are judged, and figures drawn, from the runs that there are.
// The page needs no other file.
#include <fmt/format.h>

#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "base/read_file.h"
#include "claims/findings.h"
#include "experiment.h"
#include "page/claims_part.h"
#include "page/comparison_part.h"
#include "page/environment_part.h"
#include "page/exhibits_part.h"
#include "page/pieces.h"
#include "page/profile_part.h"
#include "page/renderers_part.h"
#include "page/rivals_part.h"

namespace radiafit::harness {
namespace {

namespace fs = std::filesystem;

constexpr double heaviest_mb = 10;

/// A part of the page with a heading.
struct Section {
    const char* id;
    const char* title;
    Html inside;
    bool folded = false;  ///< until the reader unfolds it, a link leads into it, or the page is printed
};

Html section_of(const Section& section) {
    const std::string title = fmt::format("{}-title", section.id);
    Html heading = element("h2", {{"id", title}}, section.title);
    Html inside = section.folded
                      ? element("details", {{"class", "fold"}}, element("summary", heading) << section.inside)
                      : std::move(heading << section.inside);
    return element("section", {{"id", section.id}, {"aria-labelledby", title}}, inside);
}

std::vector<RunRecord> all_shown(const RunFolders& folders, const std::string& profile) {
    std::vector<RunRecord> runs;
    for (const ExperimentEntry* entry : reported_experiments())
        for (RunRecord& run : shown_runs(folders, entry->name, profile)) runs.push_back(std::move(run));
    return runs;
}

Html contents(const std::vector<Section>& sections) {
    Html list;
    for (const Section& section : sections) list << element("li", link(fmt::format("#{}", section.id), section.title));
    Html figures;
    for (const ExperimentEntry* entry : reported_experiments())
        figures << element("li", link(fmt::format("#{}", entry->name), entry->title));
    return element("nav", {{"aria-label", "Contents"}},
                   element("h2", "Contents")
                       << element("ol", list) << element("p", "Figures and tables:") << element("ul", figures));
}

Html introduction(const std::string& profile, std::span<const ClaimFindings> claims) {
    Html header = element("h1", "The paper’s claims, figures and tables, measured again");
    header << element(
        "p",
        Html("radiafit reproduces K. E. Hillesland, S. Molinov and R. Grzeszczuk, ")
            << element("i",
                       "Nonlinear Optimization Framework for Image-Based Modeling on Programmable "
                       "Graphics Hardware")
            << " (SIGGRAPH 2003). This page puts what the paper says beside what was measured here. Claims are judged "
               "by fixed rules from rows at the paper’s scale; other profiles’ figures stand beside and decide "
               "nothing. The paper’s captures are not public: its models are replaced by synthetic stand-ins of "
               "the same size. Some of its values are not in our text of the paper; then this page says so.");
    header << element("p", {{"class", "source"}},
                      Html(fmt::format("Drawn on {}, {} profile, by revision {}. Drawn again by ",
                                       utc_now().substr(0, 10), profile, git_revision()))
                          << command_line(profile == "standard" ? "make report" : "make report PROFILE=" + profile));
    header << claims_counts(claims);
    return element("header", header);
}

std::string page(Experiment& experiment, const RunFolders& folders, const fs::path& scratch) {
    const std::string& profile = experiment.profile();
    const std::vector<ClaimFindings> claims = find_claims(folders, profile);
    const std::vector<RunRecord> runs = all_shown(folders, profile);
    std::vector<Section> sections = {
        {"claims", "The claims", claims_summary(claims)},
        {"rivals", "Against other solvers", rivals_part(folders, profile)},
        {"figures", "Figures and tables", exhibits_part(folders, profile, claims, scratch)},
        {"performance-profile", "Performance profile of the solvers",
         performance_part(folders, profile, scratch / "profile"), true},
        {"rules", "Every claim: rules, figures and reason", claims_in_full(claims), true},
        {"comparison", "Against the reference", comparison_part(folders), true},
        {"environment", "Machines, builds and runs", environment_part(runs, folders.checkout), true},
    };
    if (Html renderers = renderers_part(claims); !renderers.empty())
        sections.insert(sections.begin() + 5, {"renderers", "What software renderers say", std::move(renderers), true});
    Html main;
    for (const Section& section : sections) main << section_of(section);
    const fs::path texts = experiment.root() / "experiments" / "page";
    Html head = empty_element("meta", {{"charset", "utf-8"}});
    head << empty_element("meta", {{"name", "viewport"}, {"content", "width=device-width, initial-scale=1"}})
         << empty_element("meta", {{"name", "color-scheme"}, {"content", "light dark"}})
         << element("title", "radiafit: report") << style_sheet(read_file(texts / "page.css", "style sheet"));
    Html body = element("a", {{"class", "skip"}, {"href", "#main"}}, "To the claims");
    body << introduction(profile, claims) << contents(sections) << element("main", {{"id", "main"}}, main)
         << script(read_file(texts / "page.js", "script"));
    return html_page(head, body);
}

void write_report(Experiment& experiment) {
    const RunFolders folders(experiment);
    if (!experiment.standard() && experiment.results() == experiment.root() / "results")
        throw UserError(
            "the report in `results` is of the standard configuration; say by --output where this one goes");
    const bool own_folder = experiment.profile() != "standard" && experiment.standard();
    const fs::path folder = experiment.results() / "report" / (own_folder ? experiment.profile() : "");
    const AtomicFolder scratch(fs::temp_directory_path() / "radiafit-report");
    const std::string text = page(experiment, folders, scratch.path());
    fs::create_directories(folder);
    write_file(folder / "index.html", text);
    const double megabytes = double(text.size()) / 1e6;
    if (megabytes > heaviest_mb)
        log_warning(fmt::format("the report weighs {:.1f} MB; fewer runs of other devices make it lighter", megabytes));
    log_info(fmt::format("report: {} ({:.1f} MB)", (folder / "index.html").string(), megabytes));
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("report", argc, argv, radiafit::harness::write_report,
                                             radiafit::harness::RunOption::results);
}
