#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gl/context_options.h"
#include "gl/functions.h"

namespace radiafit {

struct ContextLimits {
    int texture_size, texture_layers, draw_buffers, texture_units, fragment_ssbos, compute_ssbos, varying_components;
    int64_t ssbo_bytes, texture_buffer_texels, shared_bytes;
};

/// One entry of `radiafit devices`.
struct DeviceInfo {
    ContextKind kind;
    int device = -1;  ///< for ContextOptions::device; -1 for OSMesa
    bool software = false;
    std::string description = {};  ///< EGL vendor or driver string, before any context is made
};

/// Whether shaders run on the CPU, by GL_RENDERER.
bool is_software_renderer(const std::string& renderer);

/// A context, current on the thread that made it until another is made current.
/// Its GL objects must be destroyed while it is current; destroying the context itself is always allowed.
class Context {
public:
    /// Throws UserError with one line: library missing, device index out of range (lists what exists), version below
    /// the minimum. Makes the new context current.
    static std::unique_ptr<Context> create(const ContextOptions& options);
    virtual ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    void make_current();
    static Context& current();  ///< of this thread; throws SystemError if there is none

    const GlFunctions& functions() const { return functions_; }
    ContextKind kind() const { return options_.kind; }
    const std::string& vendor() const { return vendor_; }
    const std::string& renderer() const { return renderer_; }
    const std::string& version() const { return version_; }
    bool software() const { return software_; }  ///< shaders run on the CPU
    const ContextLimits& limits() const { return limits_; }
    bool has_extension(std::string_view name) const;  ///< such as "GL_NV_shader_atomic_float"
    /// Invocations of a work group of compute shaders that does best with `usual` on a chip; in software 8, the floats
    /// of one vector, which at a barrier waits for nothing. RADIAFIT_GROUP_SIZE, 8, 32, 64 or 128, stands for either.
    /// Fewer where the group's shared memory, so many bytes for each invocation and so many besides, would not fit the
    /// device's.
    size_t group_size(size_t usual, size_t shared_bytes_each, size_t shared_bytes = 0) const;

    /// Bytes of the GL objects made by texture.h that are alive, and the most there ever were.
    int64_t allocated_bytes() const { return allocated_bytes_; }
    int64_t peak_bytes() const { return peak_bytes_; }
    /// Makes OpenGL allocate, and counts the bytes. `make` is a call or two of functions(); `what`: of it, such as "a
    /// texture of 64 x 64 texels". Throws UserError with the bytes, those held already, and a cure, where the device
    /// has no room; SystemError where the driver refuses for another reason.
    void allocate(const std::string& what, int64_t bytes, const std::function<void()>& make);
    void count_release(int64_t bytes);
    /// Throws SystemError where an earlier command went wrong unseen: the device was reset or removed (what it holds is
    /// lost, then), or ran out of memory only as it drew. To be asked where results are read.
    void check_device();
    /// Bytes of the device's own memory that nobody uses now, where its driver tells.
    std::optional<int64_t> free_device_bytes() const;

protected:
    explicit Context(ContextOptions options) : options_(options) {}
    virtual void bind() = 0;
    virtual void unbind() = 0;
    void leave();  ///< no context is current after this, if this one was; for destructors of derived classes
    void finish_creation(void* (*resolve)(const char*), const std::string& library);

    ContextOptions options_;

private:
    friend void detail::after_gl_call(const char*);
    GLenum take_error();
    [[noreturn]] void refuse_for_memory(const std::string& what);

    GlFunctions functions_;
    std::string vendor_, renderer_, version_, debug_message_;
    ContextLimits limits_{};
    bool software_ = false;
    int64_t allocated_bytes_ = 0, peak_bytes_ = 0;
};

/// Every device a context could be made on; never throws for a missing library, it just lists nothing.
std::vector<DeviceInfo> list_devices();

struct DeviceAnswer {
    DeviceInfo device;
    std::string text;     ///< what `ask` returned
    std::string failure;  ///< how its process ended instead, such as "crashes (Segmentation fault)"; else empty
};
/// `ask` of each device, in a child process for each, where it may make a context: drivers may crash as they do. This
/// process loads no driver.
std::vector<DeviceAnswer> ask_each_device(const std::function<std::string(const DeviceInfo& device)>& ask);

namespace detail {
std::unique_ptr<Context> create_egl_context(const ContextOptions& options);
std::unique_ptr<Context> create_osmesa_context(const ContextOptions& options);
void list_egl_devices(std::vector<DeviceInfo>& devices);
void list_osmesa_devices(std::vector<DeviceInfo>& devices);
}  // namespace detail

}  // namespace radiafit
