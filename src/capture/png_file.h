#pragma once
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace radiafit {

/// Writes [height][width][3] sRGB bytes, or [height][width][4] with alpha (not multiplied), as AtomicFile does.
/// software: the program, told near the file's beginning (a tEXt chunk), or empty. Throws UserError where it cannot.
void write_png(const std::filesystem::path& file, int width, int height, const std::vector<uint8_t>& bytes8,
               std::string_view software = {});

}  // namespace radiafit
