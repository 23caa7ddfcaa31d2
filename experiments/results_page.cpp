// Prints docs/results.md: what every experiment shows and leaves, column by column.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "report/experiments.h"

namespace radiafit::harness {
namespace {

constexpr const char* introduction = R"(# The rows that experiments leave

To look at all of it first: `make report` puts every claim, figure and table on one page ([report.md](report.md)).

Every run of an experiment leaves a folder `results/EXPERIMENT/DEVICE/UTC-REVISION/` with `run.json`, which says what machine,
libraries, datasets and settings it was made with, and the files below. A line of a file is one measurement; figures and
claims are made from these rows, and every value that they show can be recomputed from them. A * in a file's name stands for
a dataset's. This page is printed by `build/release/experiments/results_page`, from what `experiments/rows` says of each column;
two runs are compared by the same ([compare.md](compare.md)).

These mean the same wherever they appear:

- A problem is one colour channel of one vertex (of a light field map), or one texel (of a reflectance model).
- E_t is a problem's objective, penalties included; its unit is the square of a pixel value, where white is 1.
- The best error of a problem is the least E_t that any solver found for it; to arrive is to come within 1.01 of it, or
  within what `tolerance` says in `run.json`.
- PSNR and APE compare rendered with photographed images over the pixels of the model; APE is in units of 1/255.
- A share is between 0 and 1. An empty field: there is no such figure. A count of iterations below 0: never.
- The renderer of a row is OpenGL's own name, or "cpu, 2 threads" for what the CPU computed; `run.json` has its model.
- A texel takes a pixel of an image if that pixel shows the texel and the texel's centre projects into it.
)";

/// What a column is, by the experiment's first file that says it.
std::string said_before(const ExperimentEntry& entry, const std::string& column) {
    for (const RowFile* file : entry.files)
        for (const Columns& group : file->columns())
            if (group.what != columns::as_before && std::ranges::count(group.names(), column))
                return fmt::format("as in {}", file->name());
    throw std::logic_error(fmt::format("{}: nothing says what column '{}' is", entry.name, column));
}

std::string line_of(const ExperimentEntry& entry, const Columns& group) {
    const std::string what = group.what == columns::as_before ? said_before(entry, group.names()[0]) : group.what;
    const auto cell = [](const std::string& text) { return text.empty() ? text : text + ' '; };
    return fmt::format("| `{}` | {}| {}|\n", fmt::join(group.names(), "`, `"), cell(group.type.unit), cell(what));
}

/// Every experiment, its files, and what their columns are.
std::string results_page() {
    std::string page = introduction;
    for (const ExperimentEntry* entry : all_experiments()) {
        page += fmt::format("\n## {}\n\n{}\n", entry->name, entry->about);
        for (const RowFile* file : entry->files) {
            page += fmt::format("\n### `{}`\n\n{}\n\n| column | unit | what it is |\n|---|---|---|\n", file->name(),
                                file->what());
            for (const Columns& group : file->columns()) page += line_of(*entry, group);
        }
    }
    return page;
}

}  // namespace
}  // namespace radiafit::harness

int main() { return std::fputs(radiafit::harness::results_page().c_str(), stdout) < 0; }
