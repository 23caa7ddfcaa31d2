#pragma once
#include <filesystem>
#include <string>

#include "base/file.h"

/// The JSON file beside records on disk: says what they are and come from, and that they are whole.
namespace radiafit {

/// Adds a checksum to a JSON object and writes the file; do it last.
void write_description(const std::filesystem::path& file, const std::string& object);
/// The JSON object. Throws UserError unless the file is whole, of this "format", version 1, and its "key" is `key`.
std::string read_description(const std::filesystem::path& file, const std::string& format, const std::string& key);
/// Throws UserError: the file isn't what was written, or isn't there.
[[noreturn]] void throw_damaged_records(const std::filesystem::path& file);
/// Opens a file beside the description. Throws UserError, as above, if there is none.
InputFile open_records_file(const std::filesystem::path& file);

}  // namespace radiafit
