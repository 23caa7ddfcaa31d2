#pragma once
#include <filesystem>
#include <string>

namespace radiafit::harness {

/// By what a command knows later whether its input is the same as it was, found within a second:
/// - of a dataset or a fit a checksum of the JSON that describes it, in which checksums of all images stand;
/// - of another file, or of all files below another folder, names and checksums if they have 32 MiB together, else
/// names,
///   sizes and when they were changed last. Hidden files are left out, and folders that a command of ours made;
/// - of a text that names nothing, such as every:8, the text.
/// The name of the file or folder itself, and where it lies, are no part of it.
std::string input_state(const std::filesystem::path& input);

}  // namespace radiafit::harness
