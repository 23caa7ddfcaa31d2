#include "fragment/image_stack.h"

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "dataset/image_stream.h"

namespace radiafit {

static_assert(ImageStream::band_rows % ImageStack::block_side == 0, "rows of blocks come from one worker");

ImageStack::ImageStack(int width, int height, int bits, int images)
    : width_(width),
      height_(height),
      images_(images),
      pixel_bytes_(size_t(bits / 2)),
      blocks_bytes_(size_t(blocks(width)) * block_side * block_side * pixel_bytes_),
      words_(Buffer::to_fill(size_t(images) * bytes(width, height, bits))),
      texture_(Texture::of_buffer(bits == 8 ? GL_R32UI : GL_RG32UI, words_)) {}

uint8_t* ImageStack::begin(PixelUploads& uploads) {
    blocks_.resize(size_t(thread_count()) * blocks_bytes_);
    return uploads.begin(words_);
}

namespace {

/// Pieces of a compile-time size, so that no copy is a call; each `from_next` and `to_next` bytes behind the last.
template <size_t piece>
void copy_pieces(const uint8_t* from, size_t from_next, uint8_t* to, size_t to_next, size_t count) {
    for (size_t i = 0; i < count; ++i, from += from_next, to += to_next) std::memcpy(to, from, piece);
}

}  // namespace

void ImageStack::put_row(uint8_t* stack, int image, int y, const uint8_t* from, int worker) {
    const size_t row = block_side * pixel_bytes_, block = block_side * row, to_next = size_t(images_) * block;
    const size_t whole = size_t(width_ / block_side), rest = size_t(width_ % block_side) * pixel_bytes_;
    uint8_t *own = blocks_.data() + size_t(worker) * blocks_bytes_, *in_block = own + size_t(y % block_side) * row;
    if (pixel_bytes_ == 4)
        copy_pieces<16>(from, row, in_block, block, whole);
    else
        copy_pieces<32>(from, row, in_block, block, whole);
    if (rest) std::memcpy(in_block + whole * block, from + whole * row, rest);
    if (y % block_side != block_side - 1 && y != height_ - 1) return;
    const size_t count = blocks_bytes_ / block;
    uint8_t* to = stack + size_t(y / block_side) * count * to_next + size_t(image) * block;
    if (pixel_bytes_ == 4)
        copy_pieces<64>(own, block, to, to_next, count);
    else
        copy_pieces<128>(own, block, to, to_next, count);
}

}  // namespace radiafit
