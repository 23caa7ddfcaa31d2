#pragma once
#include "dataset/image_stream.h"
#include "gl/texture.h"

namespace radiafit {

/// Images of one size for passes over a grid that loop over them, in a buffer texture: of 8 bits a channel R32UI, r | g
/// << 8 | b << 16 | a << 24; of 16 bits RG32UI, r | g << 16 and b | a << 16. Blocks of 4 x 4 pixels lie row by row;
/// in a block each image in turn, so that a loop walks through memory. GLSL: reflect/pixel.glsl.
class ImageStack {
public:
    /// Throws UserError beyond the context's limits.
    ImageStack(int width, int height, int bits, int images);
    /// Between begin() and end(), images in any order; what the others hold is undefined then.
    void begin();
    void put(int image, const TargetImage& pixels);
    void end();
    const Texture& texture() const { return texture_; }

    static constexpr int block_side = 4;
    static int blocks(int pixels) { return (pixels + block_side - 1) / block_side; }
    /// Bytes of one image in a stack.
    static uint64_t bytes(int width, int height, int bits) {
        return uint64_t(blocks(width)) * uint64_t(blocks(height)) * block_side * block_side * uint64_t(bits / 2);
    }

private:
    int width_, height_, bits_, images_;
    Buffer words_;
    Texture texture_;
    unsigned char* mapped_ = nullptr;  ///< between begin() and end()
};

}  // namespace radiafit
