#pragma once
#include <filesystem>
#include <string>

namespace radiafit::tools {

/// An image's name as a place below an output folder. Throws UserError for one that would lead out of it.
std::filesystem::path output_name(const std::string& image);

}  // namespace radiafit::tools
