#include "fragment/image_stack.h"

#include <algorithm>
#include <cstring>

namespace radiafit {
ImageStack::ImageStack(int width, int height, int bits, int images)
    : width_(width),
      height_(height),
      images_(images),
      pixel_bytes_(size_t(bits / 2)),
      words_(Buffer::to_fill(size_t(images) * bytes(width, height, bits))),
      texture_(Texture::of_buffer(bits == 8 ? GL_R32UI : GL_RG32UI, words_)),
      blocks_(size_t(blocks(width)) * block_side * block_side * pixel_bytes_) {}

void ImageStack::put_row(uint8_t* stack, int image, int y, const uint8_t* from) {
    const size_t row = block_side * pixel_bytes_, block = block_side * row, to_next = size_t(images_) * block;
    uint8_t* in_block = blocks_.data() + size_t(y % block_side) * row;
    for (int x = 0; x < width_; x += block_side, in_block += block, from += row)
        std::memcpy(in_block, from, size_t(std::min(block_side, width_ - x)) * pixel_bytes_);
    if (y % block_side != block_side - 1 && y != height_ - 1) return;
    uint8_t* to = stack + size_t(y / block_side) * size_t(blocks(width_)) * to_next + size_t(image) * block;
    for (size_t at = 0; at < blocks_.size(); at += block, to += to_next) std::memcpy(to, blocks_.data() + at, block);
}

}  // namespace radiafit
