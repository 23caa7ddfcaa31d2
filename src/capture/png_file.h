#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace radiafit {

/// Writes [height][width][3] sRGB bytes, as AtomicFile does. Throws UserError where it cannot.
void write_png(const std::filesystem::path& file, int width, int height, const std::vector<uint8_t>& rgb8);

}  // namespace radiafit
