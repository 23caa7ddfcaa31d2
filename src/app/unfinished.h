#pragma once
#include <filesystem>
#include <string>

/// OUT.parts: what a fit that was stopped leaves beside its place, to go on from: parts that are finished (parts.h) and
/// journals of those that aren't (base/journal.h). A fit that ends removes it.
namespace radiafit {

std::filesystem::path unfinished_folder(const std::filesystem::path& out);

/// Why a fit of this key can't go on from what a folder holds: "it is of another fit: --terms is 2 there, 3 here".
/// Empty where it can, and where nothing is there.
std::string why_not_resumable(const std::filesystem::path& folder, const std::string& key);

/// Says whether an earlier run left something there that this fit goes on from. What is of another fit, or damaged,
/// goes; with `resume` it stays, and UserError names what differs.
void settle_unfinished(const std::filesystem::path& folder, const std::string& key, bool resume);

/// Whether something is there to go on from.
bool anything_unfinished(const std::filesystem::path& folder);

/// For the last line of a fit that was stopped: what is kept, and the command that goes on. argv: its own command line.
std::string how_to_go_on(const std::filesystem::path& folder, int argc, const char* const* argv);

/// All that radiafit wrote there; the folder, too, unless it holds something else.
void remove_unfinished(const std::filesystem::path& folder);

inline constexpr const char* journal_extension = ".journal";

}  // namespace radiafit
