#pragma once
#include <vector>

#include "gl/pixel_uploads.h"

namespace radiafit {

/// Images of one size for passes over a grid that loop over them, in a buffer texture: of 8 bits a channel R32UI, r | g
/// << 8 | b << 16 | a << 24; of 16 bits RG32UI, r | g << 16 and b | a << 16. Blocks of 4 x 4 pixels lie row by row;
/// in a block each image in turn, so that a loop walks through memory. GLSL: reflect/pixel.glsl.
class ImageStack {
public:
    /// Throws UserError beyond the context's limits.
    ImageStack(int width, int height, int bits, int images);
    /// A row of an image to its places in `stack`, bytes() of all images: [width][4] channels. Rows of a row of blocks
    /// come in order, from one worker; what images hold that get none is undefined.
    void put_row(uint8_t* stack, int image, int y, const uint8_t* row, int worker);
    /// Around put_row(): where `stack` is.
    uint8_t* begin(PixelUploads& uploads);
    void end(PixelUploads& uploads) { uploads.end(words_); }
    const Texture& texture() const { return texture_; }
    size_t bytes() const { return words_.bytes(); }

    static constexpr int block_side = 4;
    static int blocks(int pixels) { return (pixels + block_side - 1) / block_side; }
    /// Bytes of one image in a stack.
    static uint64_t bytes(int width, int height, int bits) {
        return uint64_t(blocks(width)) * uint64_t(blocks(height)) * block_side * block_side * uint64_t(bits / 2);
    }

private:
    int width_, height_, images_;
    size_t pixel_bytes_, blocks_bytes_;  ///< blocks_bytes_: of a row of one image's blocks
    Buffer words_;
    Texture texture_;
    std::vector<uint8_t> blocks_;  ///< [workers][blocks_bytes_], that they are written in one piece
};

}  // namespace radiafit
