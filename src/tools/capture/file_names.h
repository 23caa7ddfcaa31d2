#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace radiafit::tools {

/// Letters from A to Z made small.
std::string lower_case(std::string text);

/// ".png" of IMAGE.PNG.
std::string lower_ending(const std::filesystem::path& file);

/// Whether a file's name begins with a dot. So do the files that a Mac writes beside each file of a foreign disk
/// (._IMG.jpg), which are no pictures whatever their ending.
bool is_hidden(const std::filesystem::path& file);

/// `chosen`, or if that is empty the folder's name, whether or not its path ends in a slash.
std::string dataset_name(const std::string& chosen, const std::filesystem::path& folder);

/// The pictures of a folder, recognized by their endings (image/image_format.h), hidden ones left out, sorted by name.
/// Throws UserError for a folder that cannot be listed.
std::vector<std::string> list_images(const std::filesystem::path& folder);

}  // namespace radiafit::tools
