#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "gl/functions.h"

/// RAII over textures, framebuffers and buffers of the current context; every allocation is counted there
/// (Context::allocated_bytes), so that a memory report says what was really allocated.
namespace radiafit {

/// A 2-D texture, or a 2-D array if layers > 0, nearest filtering, clamped, one level, all zero bits at first.
class Texture {
public:
    Texture() = default;
    /// `format`: a sized internal format such as GL_RGBA32F. Throws UserError beyond the context's limits.
    Texture(GLenum format, int width, int height, int layers = 0);
    /// A buffer texture over a buffer that must outlive it.
    static Texture of_buffer(GLenum format, const class Buffer& buffer);
    ~Texture();
    Texture(Texture&& other) noexcept { swap(other); }
    Texture& operator=(Texture&& other) noexcept {
        swap(other);
        return *this;
    }

    /// The whole of one layer; `format` and `type` describe the host's data, e.g. GL_RGBA, GL_FLOAT.
    void upload(GLenum format, GLenum type, const void* data, int layer = 0);
    /// The rectangle [0, width) x [0, height) of a plain 2-D texture.
    void upload_part(int width, int height, GLenum format, GLenum type, const void* data);
    /// One layer into `data`, whose size is `bytes`. Waits for the device.
    void download(GLenum format, GLenum type, void* data, size_t bytes, int layer = 0) const;
    void clear();  ///< to all zero bits

    GLuint name() const { return name_; }
    GLenum format() const { return format_; }
    int width() const { return width_; }
    int height() const { return height_; }
    int layers() const { return layers_; }
    int texel_bytes() const;
    int64_t bytes() const { return bytes_; }
    explicit operator bool() const { return name_ != 0; }

private:
    void swap(Texture& other) noexcept {
        std::swap(name_, other.name_);
        std::swap(format_, other.format_);
        std::swap(width_, other.width_);
        std::swap(height_, other.height_);
        std::swap(layers_, other.layers_);
        std::swap(bytes_, other.bytes_);
    }
    GLuint name_ = 0;
    GLenum format_ = 0;
    int width_ = 0, height_ = 0, layers_ = 0;
    int64_t bytes_ = 0;
};

/// Of a sized internal format. Throws SystemError for one that nothing here uses.
int bytes_per_texel(GLenum format);

/// One attachment: a texture, or one layer of an array.
struct Target {
    const Texture* texture;
    int layer = 0;
};

/// Colour attachments 0, 1, … in the order given, all drawn to; optionally a depth attachment.
class Framebuffer {
public:
    Framebuffer() = default;
    explicit Framebuffer(const std::vector<Target>& colours, const Texture* depth = nullptr);
    ~Framebuffer();
    Framebuffer(Framebuffer&& other) noexcept { swap(other); }
    Framebuffer& operator=(Framebuffer&& other) noexcept {
        swap(other);
        return *this;
    }
    /// Binds for drawing and sets the viewport to the whole of it.
    void bind() const;
    /// Binds, with a smaller viewport [0, width) x [0, height).
    void bind(int width, int height) const;
    void clear() const;  ///< all colours to zero bits
    int width() const { return width_; }
    int height() const { return height_; }
    GLuint name() const { return name_; }
    int colours() const { return static_cast<int>(formats_.size()); }
    /// Bytes of one texel of the colours [first, end), together.
    int texel_bytes(int first, int end) const;
    int texel_bytes() const { return texel_bytes(0, colours()); }

private:
    void swap(Framebuffer& other) noexcept {
        std::swap(name_, other.name_);
        std::swap(formats_, other.formats_);
        std::swap(width_, other.width_);
        std::swap(height_, other.height_);
    }
    GLuint name_ = 0;
    std::vector<GLenum> formats_;  ///< of each colour
    int width_ = 0, height_ = 0;
};

/// A buffer of fixed size.
class Buffer {
public:
    Buffer() = default;
    /// `data` may be null: the contents are undefined then. `dynamic` allows write().
    Buffer(size_t bytes, const void* data, bool dynamic = false);
    template <class T>
    explicit Buffer(const std::vector<T>& values, bool dynamic = false)
        : Buffer(values.size() * sizeof(T), values.data(), dynamic) {}
    /// Contents undefined at first; for map(), or for a copy of another one.
    static Buffer to_fill(size_t bytes);
    /// The same for map_for_good(): memory of the host, from which others are filled.
    static Buffer to_map(size_t bytes);
    ~Buffer();
    Buffer(Buffer&& other) noexcept { swap(other); }
    Buffer& operator=(Buffer&& other) noexcept {
        swap(other);
        return *this;
    }
    void write(size_t offset, size_t bytes, const void* data);
    void clear();  ///< to all zero bits
    /// For writing all that is used later, until unmap(); what it held is lost.
    uint8_t* map();
    void unmap();
    /// Once, for as long as the buffer lives: where it can be written at any time. What the device is to read it reads
    /// by commands that follow; who writes there again waits until they are done.
    uint8_t* map_for_good();
    void read(size_t offset, size_t bytes, void* data) const;
    GLuint name() const { return name_; }
    size_t bytes() const { return bytes_; }

private:
    Buffer(size_t bytes, const void* data, GLbitfield access);
    uint8_t* map(GLbitfield access);
    void swap(Buffer& other) noexcept {
        std::swap(name_, other.name_);
        std::swap(bytes_, other.bytes_);
    }
    GLuint name_ = 0;
    size_t bytes_ = 0;
};

/// Vertex attributes, all from separate buffers.
class VertexArray {
public:
    VertexArray();
    ~VertexArray();
    VertexArray(VertexArray&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    VertexArray& operator=(VertexArray&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    /// `components` floats per vertex (or per instance if divisor is 1).
    void floats(unsigned location, int components, const Buffer& buffer, unsigned divisor = 0);
    void integers(unsigned location, int components, const Buffer& buffer, unsigned divisor = 0);
    void elements(const Buffer& indices);
    void bind() const { gl().BindVertexArray(name_); }

private:
    GLuint name_ = 0;
};

}  // namespace radiafit
