#pragma once
#include <cstdint>
#include <vector>

#include "capture/image_file.h"

namespace radiafit {

/// Linear light of every stored value of an image: [2^bits], in [0, 1]. Made once, then shared.
const std::vector<float>& linear_table(int bits, bool linear);

/// The image (8 or 16 bits) at width x height, neither larger than before: every new pixel is the mean, in linear
/// light, of the area it covers, encoded again as the image was. Alpha is averaged as it stands.
ImageFile scale_down(const ImageFile& image, int width, int height);

/// Likewise for a mask of 0 and 255: 255 where at least half of the area is.
std::vector<uint8_t> scale_down_mask(const std::vector<uint8_t>& mask, int old_width, int old_height, int width,
                                     int height);

}  // namespace radiafit
