#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace radiafit::tools {

/// A page as it is written: what it shows, as JSON, and the bytes that this names (docs/viewer.md).
struct Page {
    std::string title;
    std::string json;
    std::vector<std::pair<std::string, std::string>> blobs;  ///< name, bytes
    std::string picture = {};                                ///< WebP: what is shown until the page can draw
    uint64_t written_bytes() const;                          ///< about so many, blobs in base64
};

/// Throws UserError if something is there that is no page of radiafit's, or that somebody added files to.
void check_page_target(const std::filesystem::path& place, bool single_file);

/// Into a folder, in which index.html is to be opened; or as one HTML file. Atomic. Throws as check_page_target() does.
void write_page(const std::filesystem::path& place, bool single_file, const Page& page);

/// Throws UserError where this radiafit was built without the viewer.
void require_viewer();

}  // namespace radiafit::tools
