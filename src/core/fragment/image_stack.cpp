#include "fragment/image_stack.h"

#include <algorithm>
#include <cstring>

namespace radiafit {
ImageStack::ImageStack(int width, int height, int bits, int images)
    : width_(width),
      height_(height),
      bits_(bits),
      images_(images),
      words_(Buffer::to_map(size_t(images) * bytes(width, height, bits))),
      texture_(Texture::of_buffer(bits == 8 ? GL_R32UI : GL_RG32UI, words_)) {}

void ImageStack::begin() {
    if (mapped_) end();  // an image could not be read
    mapped_ = static_cast<unsigned char*>(words_.map());
}

void ImageStack::put(int image, const TargetImage& image_pixels) {
    const void* pixels = bits_ == 8 ? static_cast<const void*>(image_pixels.rgba8.data()) : image_pixels.rgba16.data();
    const auto* from = static_cast<const unsigned char*>(pixels);
    const size_t pixel = size_t(bits_ / 2), row = block_side * pixel, block = block_side * row;
    const size_t to_next = size_t(images_) * block, to_row_below = size_t(blocks(width_)) * to_next;
    for (int y = 0; y < height_; ++y) {
        unsigned char* to =
            mapped_ + size_t(y / block_side) * to_row_below + size_t(image) * block + size_t(y % block_side) * row;
        for (int x = 0; x < width_; x += block_side, to += to_next) {
            const size_t bytes = size_t(std::min(block_side, width_ - x)) * pixel;
            std::memcpy(to, from, bytes);
            from += bytes;
        }
    }
}

void ImageStack::end() {
    words_.unmap();
    mapped_ = nullptr;
}

}  // namespace radiafit
