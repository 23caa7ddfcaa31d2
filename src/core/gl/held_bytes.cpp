#include "gl/held_bytes.h"

#include "gl/functions.h"

namespace radiafit {
namespace {

uint64_t texture_bytes(GLuint texture) {
    GLint target = 0;
    gl().GetTextureParameteriv(texture, GL_TEXTURE_TARGET, &target);
    if (target == GL_TEXTURE_BUFFER) return 0;  // its buffer counts
    const auto level = [&](GLenum what) {
        GLint value = 0;
        gl().GetTextureLevelParameteriv(texture, 0, what, &value);
        return uint64_t(value);
    };
    uint64_t bits = 0;
    for (const GLenum component : {GL_TEXTURE_RED_SIZE, GL_TEXTURE_GREEN_SIZE, GL_TEXTURE_BLUE_SIZE,
                                   GL_TEXTURE_ALPHA_SIZE, GL_TEXTURE_DEPTH_SIZE, GL_TEXTURE_STENCIL_SIZE})
        bits += level(component);
    return level(GL_TEXTURE_WIDTH) * level(GL_TEXTURE_HEIGHT) * level(GL_TEXTURE_DEPTH) * bits / 8;
}

}  // namespace

uint64_t held_bytes() {
    constexpr GLuint most = 1 << 16;
    uint64_t bytes = 0;
    for (GLuint name = 1; name < most; ++name) {
        if (gl().IsTexture(name)) bytes += texture_bytes(name);
        if (gl().IsBuffer(name)) {
            GLint64 size = 0;
            gl().GetNamedBufferParameteri64v(name, GL_BUFFER_SIZE, &size);
            bytes += uint64_t(size);
        }
    }
    return bytes;
}

}  // namespace radiafit
