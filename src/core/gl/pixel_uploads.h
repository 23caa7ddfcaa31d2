#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gl/texture.h"

namespace radiafit {

/// Pixels on their way to the device: two buffers of memory that it reads by itself, mapped for good. While it fetches
/// from one, the next pixels are written to the other, and nothing is copied between. Software, whose textures lie in
/// memory like any other, is handed them without; so is what goes there once and stays.
class PixelUploads {
public:
    enum class Use { again_and_again, once };
    explicit PixelUploads(size_t bytes, Use use = Use::again_and_again);  ///< bytes: of the most that goes at once
    ~PixelUploads();
    PixelUploads(const PixelUploads&) = delete;
    PixelUploads& operator=(const PixelUploads&) = delete;

    /// Where the next pixels for a texture are to be written, best from front to back; to read there may be slow. Waits
    /// until the device has fetched what was there before.
    uint8_t* begin();
    /// What was written since begin(), rows of pixels without gaps, becomes the rectangle [0, width) x [0, height) of a
    /// texture. `format` and `type` as for Texture::upload().
    void end(Texture& to, int width, int height, GLenum format, GLenum type);
    /// The same for the whole of a buffer made by Buffer::to_fill(); what it holds is lost.
    uint8_t* begin(Buffer& to);
    void end(Buffer& to);

private:
    struct Half {
        Buffer buffer;
        uint8_t* mapped = nullptr;
        GLsync fetched = nullptr;  ///< null: nothing is on its way
    };
    void take_turns();

    size_t bytes_;
    bool straight_;  ///< without halves
    std::array<Half, 2> halves_;
    std::vector<uint8_t> for_texture_;  ///< where straight_
    Buffer* filled_ = nullptr;          ///< between begin() and end(), where straight_
    size_t turn_ = 0;
};

}  // namespace radiafit
