#pragma once
#include <filesystem>

/// What processes that were killed leave behind, and how the next ones know it. A run that is killed or crashes leaves
/// its hidden names (temporary_name.h), and the next that writes into the same folder removes them. A process holds a
/// lock (flock) on each as long as it lives.
namespace radiafit {

/// Locks a file or a folder until the descriptor is closed or the process dies. -1: it is gone, another holds it, or
/// this file system has no locks.
int lock_path(const std::filesystem::path& path);

/// What a path's last name leads to where it is a link, or a chain of them: it need not be there. "results/" is
/// "results"; nothing else of the path changes, for behind a link to a folder ".." is that folder's parent. Throws
/// UserError for links in a circle.
std::filesystem::path follow_links(std::filesystem::path path);

/// Removes what dead processes left in `folder`. What one of them was replacing goes too where the newer one exists;
/// else it gets its name back.
void clear_leftovers(const std::filesystem::path& folder);

/// Gives a folder its name back that a process was killed replacing: possible only where the file system exchanges no
/// names. For readers; does nothing where `folder`, or what it leads to, exists.
void restore_interrupted(const std::filesystem::path& folder);

}  // namespace radiafit
