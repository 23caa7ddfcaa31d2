#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "publish/page_model.h"

namespace radiafit::tools {

/// A map in steps: value (or its signed root) = scale (q - bias) of whole numbers q, each channel with its own scale. q
/// has 16 bits, in two images of bytes; the upper one is left out where 8 bits do.
struct CodedMap {
    std::array<float, 3> scale{1, 1, 1}, offset{};  ///< offset = -bias scale, so that zeros come back as zeros
    std::string low, high;                          ///< lossless WebP; high may be empty
    size_t bytes() const { return low.size() + high.size(); }
};

/// step: of each channel. Throws UserError where the image is too large for the format.
CodedMap code_map(const PageMap& map, const std::array<float, 3>& step);
/// What a page gets of a coded map: read back from the bytes, by the same sums in single precision. `like`: the map
/// that it was made from.
PageMap decoded_map(const CodedMap& coded, const PageMap& like);

/// A value as it is stored: itself, or its signed root.
float stored_number(const PageMap& map, float value);
float number_of(const PageMap& map, float stored);

}  // namespace radiafit::tools
