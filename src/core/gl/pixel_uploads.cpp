#include "gl/pixel_uploads.h"

#include "base/error.h"
#include "gl/context.h"

namespace radiafit {

PixelUploads::PixelUploads(size_t bytes, Use use)
    : bytes_(bytes), straight_(use == Use::once || Context::current().software()) {
    if (straight_) return;
    for (Half& half : halves_) {
        half.buffer = Buffer::to_map(bytes);
        half.mapped = half.buffer.map_for_good();
    }
}

PixelUploads::~PixelUploads() {
    for (const Half& half : halves_)
        if (half.fetched) gl().DeleteSync(half.fetched);
}

uint8_t* PixelUploads::begin() {
    if (straight_) {
        for_texture_.resize(bytes_);
        return for_texture_.data();
    }
    Half& half = halves_[turn_];
    if (half.fetched) {
        constexpr GLuint64 second = 1'000'000'000;
        GLenum state = GL_TIMEOUT_EXPIRED;
        while (state == GL_TIMEOUT_EXPIRED)
            state = gl().ClientWaitSync(half.fetched, GL_SYNC_FLUSH_COMMANDS_BIT, second);
        if (state == GL_WAIT_FAILED) {
            Context::current().check_device();
            throw SystemError("OpenGL cannot tell when it has fetched an image");
        }
        gl().DeleteSync(half.fetched);
        half.fetched = nullptr;
    }
    return half.mapped;
}

void PixelUploads::end(Texture& to, int width, int height, GLenum format, GLenum type) {
    if (straight_) return to.upload_part(width, height, format, type, for_texture_.data());
    gl().BindBuffer(GL_PIXEL_UNPACK_BUFFER, halves_[turn_].buffer.name());
    to.upload_part(width, height, format, type, nullptr);  // from the start of the buffer
    gl().BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    take_turns();
}

uint8_t* PixelUploads::begin(Buffer& to) {
    if (!straight_) return begin();
    if (filled_) end(*filled_);  // an image could not be read
    filled_ = &to;
    return to.map();
}

void PixelUploads::end(Buffer& to) {
    if (straight_) {
        filled_ = nullptr;
        return to.unmap();
    }
    // What it held is lost, so that no driver needs to wait until passes before have read it.
    gl().InvalidateBufferData(to.name());
    gl().CopyNamedBufferSubData(halves_[turn_].buffer.name(), to.name(), 0, 0, GLsizeiptr(to.bytes()));
    take_turns();
}

void PixelUploads::take_turns() {
    halves_[turn_].fetched = gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    turn_ = 1 - turn_;
}

}  // namespace radiafit
