#include "show_rows.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/read_file.h"
#include "report/figures.h"
#include "report/row_files.h"

namespace radiafit::harness {
namespace fs = std::filesystem;
namespace {

/// A caption that is longer than a figure is wide: broken behind the part ("one; two; three") that ends nearest to its
/// middle.
std::string in_two_lines(std::string caption) {
    constexpr size_t widest = 120;
    if (caption.size() <= widest) return caption;
    const auto off_middle = [&](size_t at) { return std::abs(double(at) - double(caption.size()) / 2); };
    size_t best = std::string::npos;
    for (size_t at = caption.find("; "); at != std::string::npos; at = caption.find("; ", at + 1))
        if (best == std::string::npos || off_middle(at) < off_middle(best)) best = at;
    if (best != std::string::npos) caption[best + 1] = '\n';
    return caption;
}

}  // namespace

std::vector<fs::path> show_rows(const fs::path& checkout, const std::string& name, const fs::path& rows,
                                const std::string& caption, const fs::path& folder) {
    fs::create_directories(folder);
    std::vector<fs::path> shown;
    if (const fs::path table = rows / (name + ".md"); fs::exists(table)) {
        shown.push_back(folder / table.filename());
        write_file(shown.back(), read_file(table, "table"));
    }
    const fs::path script = checkout / "paper_figs" / (name + ".gp");
    if (fs::exists(script)) {
        draw_figure(script, folder / name, {{"rows", rows.string()}, {"caption", in_two_lines(caption)}});
        for (const char* extension : {".svg", ".png"}) shown.push_back(folder / (name + extension));
    }
    return shown;
}

std::vector<fs::path> show_run(const fs::path& checkout, const RunRecord& run, const fs::path& folder) {
    if (run.caption.empty())
        throw UserError(fmt::format("{}: of an older version; run the experiment again", run.folder.string()));
    std::set<std::string> files;
    for (const std::string& file : run_files(run.folder)) files.insert(file);
    for (const auto& [file, description] : run.files) files.insert(file);
    const AtomicFolder unpacked(folder / (run.experiment + "-rows"));  // never committed, so it is removed at the end
    for (const std::string& file : files) write_file(unpacked.path() / file, read_run_file(run, file));
    return show_rows(checkout, run.experiment, unpacked.path(), run.caption, folder);
}

}  // namespace radiafit::harness
