#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "image/web/webp_image.h"
#include "publish/page_model.h"

namespace radiafit::tools {

/// A map in steps: value (or its signed root) = scale (q - bias) of whole numbers q, each channel with its own scale. q
/// has 16 bits, in two images of bytes; the upper one is left out where 8 bits do.
struct SteppedMap {
    std::array<float, 3> scale{1, 1, 1}, offset{};  ///< offset = -bias scale, so that zeros come back as zeros
    ByteRaster low, high;                           ///< high may be empty
};
/// step: of each channel.
SteppedMap stepped_map(const PageMap& map, const std::array<float, 3>& step);
/// The numbers that the steps stand for, by the page's own sums in single precision. `like`: the map that they are of.
PageMap decoded_map(const SteppedMap& stepped, const PageMap& like);

/// The same as a page has it.
struct CodedMap {
    std::array<float, 3> scale{1, 1, 1}, offset{};
    std::string low, high;  ///< lossless WebP; high may be empty
    size_t bytes() const { return low.size() + high.size(); }
};
/// Throws UserError where the image is too large for the format.
CodedMap code_map(const SteppedMap& stepped);
/// What a browser reads.
SteppedMap stepped_map(const CodedMap& coded);
/// About how many bytes code_map() makes of it, by bands of it, which are share_of_bands of a large map; and which
/// share of this one they are.
size_t expected_bytes(const SteppedMap& stepped);
double share_coded(const SteppedMap& stepped);
inline constexpr double share_of_bands = 0.125;

/// A value as it is stored: itself, or its signed root.
float stored_number(const PageMap& map, float value);
float number_of(const PageMap& map, float stored);

}  // namespace radiafit::tools
