#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "report/finished_runs.h"

/// From an experiment's rows to what people look at.
namespace radiafit::harness {

/// Draws the checkout's paper_figs/NAME.gp, if it has one, over the rows in a folder, and copies NAME.md from among
/// them; returns the files that it left in `folder`. Throws as draw_figure() does.
std::vector<std::filesystem::path> show_rows(const std::filesystem::path& checkout, const std::string& name,
                                             const std::filesystem::path& rows, const std::string& caption,
                                             const std::filesystem::path& folder);

/// The same of a finished run, whose rows may be packed. Throws UserError, too, for a run whose files are not all there
/// as it wrote them, and for one of a version that noted no caption.
std::vector<std::filesystem::path> show_run(const std::filesystem::path& checkout, const RunRecord& run,
                                            const std::filesystem::path& folder);

}  // namespace radiafit::harness
