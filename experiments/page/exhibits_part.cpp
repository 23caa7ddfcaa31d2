#include "exhibits_part.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "claims_part.h"
#include "page/html_table.h"
#include "pieces.h"
#include "show_rows.h"

namespace radiafit::harness {
namespace {

namespace fs = std::filesystem;

std::string command_of(const ExperimentEntry& entry, const std::string& profile) {
    const std::string command = fmt::format("make {} PROFILE={}", entry.target, profile);
    return entry.target == std::string(entry.name) ? command : fmt::format("{} ONLY={}", command, entry.name);
}

std::string name_of_run(const RunFolders& folders, const RunRecord& run) {
    return fs::relative(run.folder, folders.checkout).generic_string();
}

/// What one run has to show.
class RunPart {
public:
    RunPart(const ExperimentEntry& entry, const RunRecord& run, const RunFolders& folders, fs::path scratch)
        : entry_(entry), run_(run), folders_(folders), scratch_(std::move(scratch)) {}

    Html html() const {
        Html part;
        if (*entry_.figure) part << figure();
        for (const char* file : entry_.tables) part << table(file);
        return part;
    }

private:
    Html told_by() const {
        Html told = run_.caption.empty() ? Html(run_.utc.substr(0, 10)) : Html(run_.caption);
        return told << fmt::format(" ({} profile; ", run_.profile) << element("code", name_of_run(folders_, run_))
                    << ")";
    }

    Html figure() const {
        try {
            show_run(folders_.checkout, run_, scratch_);
        } catch (const UserError& e) {
            return not_run(fmt::format("the figure: {}", e.what()));
        } catch (const SystemError& e) {  // rows of an older version
            return not_run(
                fmt::format("the figure cannot be drawn from these rows; run the experiment again ({})", e.what()));
        }
        return element("figure", scroll_box(entry_.title, image(scratch_ / run_.experiment, entry_.figure))
                                     << element("figcaption", told_by()));
    }

    Html table(const std::string& file) const {
        try {
            Html part = file.ends_with(".md") ? html_of_markdown(entry_.title, read_run_file(run_, file))
                                              : rows_table(run_, file);
            if (!*entry_.figure) part << element("p", {{"class", "caption"}}, told_by());
            return part;
        } catch (const UserError& e) {
            return not_run(fmt::format("the table: {}", e.what()));
        }
    }

    const ExperimentEntry& entry_;
    const RunRecord& run_;
    const RunFolders& folders_;
    fs::path scratch_;
};

Html paper_says(const ExperimentEntry& entry) {
    Html says;
    if (*entry.section)
        says << element("p", element("b", fmt::format("The paper, Section {}. ", entry.section)) << entry.paper);
    else
        says << element("p", "The paper has nothing like it.");
    return element("div", {{"class", "paper"}}, says);
}

Html article_of(const ExperimentEntry& entry, const RunFolders& folders, const std::string& profile,
                std::span<const ClaimFindings> claims, const fs::path& scratch) {
    Html article = paper_says(entry);
    article << claims_of(claims, entry.name);
    const std::vector<RunRecord> runs = shown_runs(folders, entry.name, profile);
    Html others;
    size_t other_count = 0;
    for (size_t i = 0; i < runs.size(); ++i) {
        const Html part = RunPart(entry, runs[i], folders, scratch / std::to_string(i)).html();
        if (i == 0) {
            article << part;
        } else {
            others << part;
            ++other_count;
        }
    }
    if (runs.empty()) article << not_run(fmt::format("no {} results; ", entry.name) + command_of(entry, profile));
    if (!others.empty())
        article << element("details", element("summary", fmt::format("{} more run{}: other profiles and machines",
                                                                     other_count, other_count == 1 ? "" : "s"))
                                          << others);
    article << element("p", {{"class", "source"}},
                       Html("Made anew by ")
                           << command_line(command_of(entry, runs.empty() ? profile : runs.front().profile)));
    return element("article", {{"class", "exhibit"}, {"id", entry.name}},
                   element("details", {{"class", "fold"}}, element("summary", element("h3", entry.title)) << article));
}

}  // namespace

std::vector<RunRecord> shown_runs(const RunFolders& folders, const std::string& experiment,
                                  const std::string& profile) {
    std::vector<std::string> profiles = {judged_profile};
    if (profile != judged_profile) profiles.push_back(profile);
    std::vector<RunRecord> shown;
    for (const std::string& one : profiles) {
        std::vector<RunRecord> runs = folders.newest(experiment, one);
        std::ranges::sort(runs, std::ranges::greater(),
                          [](const RunRecord& run) { return std::pair(!run.rounds_left_out, run.utc); });
        std::ranges::move(runs, std::back_inserter(shown));
    }
    return shown;
}

Html exhibits_part(const RunFolders& folders, const std::string& profile, std::span<const ClaimFindings> claims,
                   const fs::path& scratch) {
    const std::vector<const ExperimentEntry*> all = reported_experiments();
    std::vector<Html> articles(all.size());
    Progress progress("figures and tables", all.size());
    parallel_for(all.size(), 1, [&](size_t i, int) {
        articles[i] = article_of(*all[i], folders, profile, claims, scratch / all[i]->name);
        progress.advance();
    });
    Html part;
    for (const Html& article : articles) part << article;
    return part;
}

}  // namespace radiafit::harness
