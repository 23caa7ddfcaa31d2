#pragma once
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace radiafit {

/// Writes [height][width][3] sRGB bytes, as AtomicFile does. software: the program, told near the file's beginning
/// (a tEXt chunk), or empty. Throws UserError where it cannot.
void write_png(const std::filesystem::path& file, int width, int height, const std::vector<uint8_t>& rgb8,
               std::string_view software = {});

}  // namespace radiafit
