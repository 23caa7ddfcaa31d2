#pragma once
#include <cstring>
#include <vector>

#include "base/half.h"
#include "fragment/map_vector.h"

namespace radiafit {

/// One layer of an N-texel array on its way to the device or back, as the texture's storage holds it: 16 bytes a texel
/// of floats or 8 of halves.
class StoredLayer {
public:
    StoredLayer(const Texture& texture, Storage storage)
        : texture_(&texture),
          storage_(storage),
          bytes_(storage == Storage::fp32 ? 16 : 8),
          data_(size_t(texture.width()) * texture.height() * bytes_) {}
    /// rgb [4], of which the last isn't read.
    void put(int x, int y, const float* rgb) {
        uint8_t* at = data_.data() + (size_t(y) * texture_->width() + x) * bytes_;
        if (storage_ == Storage::fp32) {
            std::memcpy(at, rgb, 12);
            return;
        }
        for (int c = 0; c < 3; ++c) {
            const uint16_t half =
                storage_ == Storage::fp16 ? half_from_float(rgb[c]) : half_from_float_truncated(rgb[c]);
            std::memcpy(at + 2 * c, &half, 2);
        }
    }
    /// rgb [4]: the last becomes 0.
    void get(int x, int y, float* rgb) const {
        const uint8_t* at = data_.data() + (size_t(y) * texture_->width() + x) * bytes_;
        if (storage_ == Storage::fp32) {
            std::memcpy(rgb, at, 12);
        } else {
            for (int c = 0; c < 3; ++c) {
                uint16_t half;
                std::memcpy(&half, at + 2 * c, 2);
                rgb[c] = float_from_half(half);
            }
        }
        rgb[3] = 0;
    }
    /// RG32UI holds two packed pairs of halves, which on a little-endian machine is four halves in a row.
    GLenum format() const { return storage_ == Storage::fp16 ? GL_RG_INTEGER : GL_RGBA; }
    GLenum type() const {
        return storage_ == Storage::fp32 ? GL_FLOAT : storage_ == Storage::fp16 ? GL_UNSIGNED_INT : GL_HALF_FLOAT;
    }
    std::vector<uint8_t>& data() { return data_; }

private:
    const Texture* texture_;
    Storage storage_;
    size_t bytes_;
    std::vector<uint8_t> data_;
};

}  // namespace radiafit
