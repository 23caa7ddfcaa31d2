#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace radiafit {

/// [height][width][3] sRGB bytes, or [height][width][4] with alpha (not multiplied), as a PNG file's bytes. software:
/// the program, named near the beginning (a tEXt chunk), or empty. Throws SystemError where libpng fails.
std::string png_bytes(int width, int height, const std::vector<uint8_t>& bytes8, std::string_view software = {});

/// [height][width] of 16 bits, as a grey PNG's bytes: numbers, which no transfer function is to change (gAMA 1). Throws
/// as png_bytes() does.
std::string grey16_png_bytes(int width, int height, const std::vector<uint16_t>& values,
                             std::string_view software = {});

/// Writes png_bytes() as AtomicFile does. Throws UserError where it cannot.
void write_png(const std::filesystem::path& file, int width, int height, const std::vector<uint8_t>& bytes8,
               std::string_view software = {});

}  // namespace radiafit
