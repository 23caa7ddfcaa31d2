#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// The only user of OpenEXR: scan-line images of named channels.
namespace radiafit {

enum class ExrType { float32, float16 };

struct ExrImage {
    int width = 0, height = 0;
    std::vector<std::string> channels;         ///< C names, such as R, G, B or error.R
    std::vector<float> values;                 ///< [height][width][C], row 0 on top
    std::map<std::string, std::string> notes;  ///< string attributes of the header
};

/// Lossless (ZIP) for float32, bit for bit and NaN included; float16 rounds to nearest even.
/// Written under a temporary name and renamed. Throws UserError when the file cannot be written.
void write_exr(const std::filesystem::path& path, const ExrImage& image, ExrType type = ExrType::float32);

/// Channels come back in the order of `channels`; those not named there are not read. An empty list reads all, in the
/// file's (alphabetic) order. `size`: the columns and rows that the image must have; without it, any that the file is
/// long enough to hold. Throws UserError, before memory is taken for the pixels, for another size and a missing
/// channel; and when the file cannot be read whole.
ExrImage read_exr(const std::filesystem::path& path, const std::vector<std::string>& channels = {},
                  std::optional<std::array<int, 2>> size = {});

}  // namespace radiafit
