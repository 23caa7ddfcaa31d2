#include "gl/texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "base/wording.h"
#include "gl/context.h"

namespace radiafit {

int bytes_per_texel(GLenum format) {
    switch (format) {
        case GL_R8:
        case GL_R8UI:
            return 1;
        case GL_R16UI:
        case GL_R16F:
            return 2;
        case GL_R32UI:
        case GL_R32F:
        case GL_RGBA8:
        case GL_RGBA8UI:
        case GL_RG16F:
        case GL_DEPTH_COMPONENT32F:
            return 4;
        case GL_RGBA16UI:
        case GL_RGBA16F:
        case GL_RG32UI:
        case GL_RG32F:
            return 8;
        case GL_RGBA32UI:
        case GL_RGBA32F:
            return 16;
        default:
            throw SystemError(fmt::format("texture format 0x{:04x} has no size in bytes_per_texel", format));
    }
}

namespace {

bool holds_integers(GLenum format) {
    constexpr GLenum formats[] = {GL_R8UI, GL_RGBA8UI, GL_R16UI, GL_RGBA16UI, GL_R32UI, GL_RG32UI, GL_RGBA32UI};
    return std::find(std::begin(formats), std::end(formats), format) != std::end(formats);
}

}  // namespace

// Delegates: where the rest of it throws, the destructor runs.
Texture::Texture(GLenum format, int width, int height, int layers) : Texture() {
    Context& context = Context::current();
    const ContextLimits& limits = context.limits();
    if (width > limits.texture_size || height > limits.texture_size || layers > limits.texture_layers)
        throw UserError(
            fmt::format("a texture of {} x {} texels{} is beyond this device's limit of {}: use a smaller {} or {}, "
                        "or a smaller mesh",
                        width, height, layers ? fmt::format(" in {} layers", layers) : "",
                        layers > limits.texture_layers ? fmt::format("{} layers", limits.texture_layers)
                                                       : std::to_string(limits.texture_size),
                        option_name("surface-side"), option_name("view-side")));
    format_ = format, width_ = width, height_ = height, layers_ = layers;
    gl().CreateTextures(layers ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D, 1, &name_);
    const int64_t bytes = int64_t(bytes_per_texel(format)) * width * height * std::max(layers, 1);
    context.allocate(fmt::format("a texture of {} x {} x {} texels", width, height, std::max(layers, 1)), bytes, [&] {
        if (layers)
            gl().TextureStorage3D(name_, 1, format, width, height, layers);
        else
            gl().TextureStorage2D(name_, 1, format, width, height);
    });
    bytes_ = bytes;
    for (GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl().TextureParameteri(name_, filter, GL_NEAREST);
    for (GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) gl().TextureParameteri(name_, wrap, GL_CLAMP_TO_EDGE);
    if (format != GL_DEPTH_COMPONENT32F) clear();
}

Texture Texture::of_buffer(GLenum format, const Buffer& buffer) {
    const auto texels = int64_t(buffer.bytes() / static_cast<size_t>(bytes_per_texel(format)));
    if (texels > Context::current().limits().texture_buffer_texels)
        throw UserError(fmt::format(
            "a buffer texture of {} texels is beyond this device's limit of {}: use a smaller mesh, or smaller images",
            texels, Context::current().limits().texture_buffer_texels));
    Texture texture;
    gl().CreateTextures(GL_TEXTURE_BUFFER, 1, &texture.name_);
    gl().TextureBuffer(texture.name_, format, buffer.name());
    texture.format_ = format;
    return texture;
}

Texture::~Texture() {
    if (!name_) return;
    gl().DeleteTextures(1, &name_);
    Context::current().count_release(bytes_);
}

void Texture::upload(GLenum format, GLenum type, const void* data, int layer) {
    if (layers_)
        gl().TextureSubImage3D(name_, 0, 0, 0, layer, width_, height_, 1, format, type, data);
    else
        gl().TextureSubImage2D(name_, 0, 0, 0, width_, height_, format, type, data);
}

void Texture::upload_part(int width, int height, GLenum format, GLenum type, const void* data) {
    gl().TextureSubImage2D(name_, 0, 0, 0, width, height, format, type, data);
}

void Texture::download(GLenum format, GLenum type, void* data, size_t bytes, int layer) const {
    Context::current().check_device();
    gl().GetTextureSubImage(name_, 0, 0, 0, layer, width_, height_, 1, format, type, static_cast<GLsizei>(bytes), data);
}

void Texture::clear() {
    const bool integer = holds_integers(format_);
    gl().ClearTexImage(name_, 0, integer ? GL_RGBA_INTEGER : GL_RGBA, integer ? GL_UNSIGNED_INT : GL_FLOAT, nullptr);
}

int Texture::texel_bytes() const { return bytes_per_texel(format_); }

Framebuffer::Framebuffer(const std::vector<Target>& colours, const Texture* depth) {
    gl().CreateFramebuffers(1, &name_);
    std::vector<GLenum> buffers;
    for (const Target& target : colours) {
        const GLenum attachment = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(buffers.size());
        if (target.texture->layers())
            gl().NamedFramebufferTextureLayer(name_, attachment, target.texture->name(), 0, target.layer);
        else
            gl().NamedFramebufferTexture(name_, attachment, target.texture->name(), 0);
        buffers.push_back(attachment);
        formats_.push_back(target.texture->format());
        width_ = target.texture->width();
        height_ = target.texture->height();
    }
    if (depth) gl().NamedFramebufferTexture(name_, GL_DEPTH_ATTACHMENT, depth->name(), 0);
    gl().NamedFramebufferDrawBuffers(name_, static_cast<GLsizei>(buffers.size()), buffers.data());
    const GLenum status = gl().CheckNamedFramebufferStatus(name_, GL_DRAW_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        throw SystemError(fmt::format("glCheckNamedFramebufferStatus gives 0x{:04x} for {} targets of {} x {}", status,
                                      colours.size(), width_, height_));
}

Framebuffer::~Framebuffer() {
    if (name_) gl().DeleteFramebuffers(1, &name_);
}

int Framebuffer::texel_bytes(int first, int end) const {
    return std::accumulate(formats_.begin() + first, formats_.begin() + end, 0,
                           [](int sum, GLenum format) { return sum + bytes_per_texel(format); });
}

void Framebuffer::bind() const { bind(width_, height_); }

void Framebuffer::bind(int width, int height) const {
    gl().BindFramebuffer(GL_DRAW_FRAMEBUFFER, name_);
    gl().Viewport(0, 0, width, height);
}

void Framebuffer::clear() const {
    const float zero[4] = {0, 0, 0, 0};
    const GLuint none[4] = {0, 0, 0, 0};
    for (int i = 0; i < colours(); ++i)
        if (holds_integers(formats_[size_t(i)]))
            gl().ClearNamedFramebufferuiv(name_, GL_COLOR, i, none);
        else
            gl().ClearNamedFramebufferfv(name_, GL_COLOR, i, zero);
}

Buffer::Buffer(size_t bytes, const void* data, bool dynamic)
    : Buffer(bytes, data, GLbitfield(dynamic ? GL_DYNAMIC_STORAGE_BIT : 0)) {}

namespace {
constexpr GLbitfield mapped_for_good = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
}

Buffer Buffer::to_map(size_t bytes) { return Buffer(bytes, nullptr, mapped_for_good); }
Buffer Buffer::to_fill(size_t bytes) { return Buffer(bytes, nullptr, GLbitfield(GL_MAP_WRITE_BIT)); }

Buffer::Buffer(size_t bytes, const void* data, GLbitfield access) : Buffer() {
    gl().CreateBuffers(1, &name_);
    // GL has no empty buffers; a mesh without, say, rings still gets a name to bind.
    static const uint64_t nothing = 0;
    Context::current().allocate(fmt::format("a buffer of {} bytes", bytes), int64_t(bytes), [&] {
        gl().NamedBufferStorage(name_, GLsizeiptr(bytes ? bytes : sizeof nothing), bytes ? data : &nothing, access);
    });
    bytes_ = bytes;
}

Buffer::~Buffer() {
    if (!name_) return;
    gl().DeleteBuffers(1, &name_);
    Context::current().count_release(int64_t(bytes_));
}

void Buffer::write(size_t offset, size_t bytes, const void* data) {
    gl().NamedBufferSubData(name_, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::clear() { gl().ClearNamedBufferData(name_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr); }

uint8_t* Buffer::map(GLbitfield access) {
    void* bytes = gl().MapNamedBufferRange(name_, 0, static_cast<GLsizeiptr>(bytes_), access);
    if (!bytes) {
        Context::current().check_device();
        throw SystemError(fmt::format("OpenGL cannot map a buffer of {} bytes", bytes_));
    }
    return static_cast<uint8_t*>(bytes);
}

uint8_t* Buffer::map() { return map(GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT); }
uint8_t* Buffer::map_for_good() { return map(mapped_for_good); }

void Buffer::unmap() {
    if (!gl().UnmapNamedBuffer(name_)) throw SystemError("OpenGL lost the contents of a mapped buffer");
}

void Buffer::read(size_t offset, size_t bytes, void* data) const {
    Context::current().check_device();
    gl().GetNamedBufferSubData(name_, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
}

VertexArray::VertexArray() { gl().CreateVertexArrays(1, &name_); }

VertexArray::~VertexArray() {
    if (name_) gl().DeleteVertexArrays(1, &name_);
}

void VertexArray::floats(unsigned location, int components, const Buffer& buffer, unsigned divisor) {
    gl().VertexArrayVertexBuffer(name_, location, buffer.name(), 0, components * static_cast<GLsizei>(sizeof(float)));
    gl().VertexArrayAttribFormat(name_, location, components, GL_FLOAT, GL_FALSE, 0);
    gl().VertexArrayAttribBinding(name_, location, location);
    gl().VertexArrayBindingDivisor(name_, location, divisor);
    gl().EnableVertexArrayAttrib(name_, location);
}

void VertexArray::elements(const Buffer& indices) { gl().VertexArrayElementBuffer(name_, indices.name()); }

void VertexArray::integers(unsigned location, int components, const Buffer& buffer, unsigned divisor) {
    gl().VertexArrayVertexBuffer(name_, location, buffer.name(), 0,
                                 components * static_cast<GLsizei>(sizeof(uint32_t)));
    gl().VertexArrayAttribIFormat(name_, location, components, GL_UNSIGNED_INT, 0);
    gl().VertexArrayAttribBinding(name_, location, location);
    gl().VertexArrayBindingDivisor(name_, location, divisor);
    gl().EnableVertexArrayAttrib(name_, location);
}

}  // namespace radiafit
