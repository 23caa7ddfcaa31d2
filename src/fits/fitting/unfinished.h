#pragma once
#include <filesystem>
#include <string>

#include "base/rings.h"

/// OUT.parts: what a fit that was stopped leaves beside its place, to go on from: parts that are finished (parts.h) and
/// journals of those that aren't (base/journal.h). A fit that ends removes it.
namespace radiafit::fits {

inline constexpr const char* journal_extension = ".journal";

std::filesystem::path unfinished_folder(const std::filesystem::path& out);

/// Whether something is there to go on from.
bool anything_unfinished(const std::filesystem::path& folder);

/// What a user whose fit was stopped is told of it.
std::string what_is_unfinished(const std::filesystem::path& folder);

/// Why a fit of this key can't go on from what a folder holds: "holds parts of another fit: --terms is 2 there, 3
/// here". Empty where it can, and where nothing is there. Throws UserError for a damaged part.
std::string why_not_resumable(const std::filesystem::path& folder, const std::string& key);

/// Says whether an earlier run left something there that this fit goes on from. What is of another fit is removed;
/// with `resume` it stays, and UserError names what differs.
void check_unfinished(const std::filesystem::path& folder, const std::string& key, bool resume);

/// What a run that was killed as it ended left beside a finished output: an unfinished folder none of whose files is
/// newer than it, and hidden names. One that is newer is of a run that was to replace the output, and stays.
void remove_leftovers_of(const std::filesystem::path& out);

/// Removes all that radiafit wrote there; the folder, too, unless it holds something else.
void remove_unfinished(const std::filesystem::path& folder);

}  // namespace radiafit::fits
