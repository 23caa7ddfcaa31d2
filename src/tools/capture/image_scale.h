#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "image/image_file.h"

namespace radiafit::tools {

/// Linear light of every stored value of an image: [2^bits], in [0, 1]. Made once, then shared.
const std::vector<float>& linear_table(int bits, bool linear);

/// Linear light back to the nearest stored value of 8 or 16 bits, as rounding srgb_encode() does, from tables.
class LightCoder {
public:
    /// Made once for each kind, then shared.
    static const LightCoder& of(int bits, bool linear);
    uint16_t stored(float light) const {
        const float cell = std::clamp(light, 0.0f, 1.0f) * cells;
        size_t value = first_[size_t(cell)];
        while (value + 1 < least_.size() && light >= least_[value + 1]) ++value;
        return static_cast<uint16_t>(value);
    }

private:
    LightCoder(int bits, bool linear);

    static constexpr int cells = 1 << 16;
    std::vector<uint16_t> first_;  ///< the stored value at the beginning of each cell of light
    std::vector<float> least_;     ///< least light of every stored value
};

/// Width and height, scaled alike to a longest side of at most `max_size` pixels; as they are if that is 0.
std::array<int, 2> size_within(int width, int height, int max_size);

/// The image at width x height, neither larger than before: every new pixel is the mean, in linear light, of the area
/// it covers, encoded again as the image was. Floats are averaged as they are, and so is alpha.
ImageFile scale_down(const ImageFile& image, int width, int height);

/// A mask of 0 and 255 at width x height: 255 where at least half of the area is.
std::vector<uint8_t> scale_down_mask(const std::vector<uint8_t>& mask, int old_width, int old_height, int width,
                                     int height);

}  // namespace radiafit::tools
