#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gl/context_options.h"
#include "gl/functions.h"

namespace radiafit {

struct ContextLimits {
    int texture_size, draw_buffers, texture_units, fragment_ssbos, compute_ssbos, varying_components;
    int64_t ssbo_bytes, texture_buffer_texels;
};

/// One entry of `radiafit devices`.
struct DeviceInfo {
    ContextKind kind;
    int device;  ///< for ContextOptions::device; -1 for OSMesa
    bool software;
    std::string description;  ///< EGL vendor or driver string, before any context is made
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
    bool software() const { return software_; }  ///< shaders run on the CPU: clocks differ (timer.h)
    const ContextLimits& limits() const { return limits_; }
    bool has_extension(std::string_view name) const;  ///< such as "GL_NV_shader_atomic_float"

    /// Bytes of the GL objects made by texture.h that are alive, and the most there ever were.
    int64_t allocated_bytes() const { return allocated_bytes_; }
    int64_t peak_bytes() const { return peak_bytes_; }
    void count_allocation(int64_t bytes);

protected:
    explicit Context(ContextOptions options) : options_(options) {}
    virtual void bind() = 0;
    virtual void unbind() = 0;
    void leave();  ///< no context is current after this, if this one was; for destructors of derived classes
    void finish_creation(void* (*resolve)(const char*), const std::string& library);

    ContextOptions options_;

private:
    friend void detail::after_gl_call(const char*);
    GlFunctions functions_;
    std::string vendor_, renderer_, version_, debug_message_;
    ContextLimits limits_{};
    bool software_ = false;
    int64_t allocated_bytes_ = 0, peak_bytes_ = 0;
};

/// Every device a context could be made on; never throws for a missing library, it just lists nothing.
std::vector<DeviceInfo> list_devices();

namespace detail {
std::unique_ptr<Context> create_egl_context(const ContextOptions& options);
std::unique_ptr<Context> create_osmesa_context(const ContextOptions& options);
void list_egl_devices(std::vector<DeviceInfo>& devices);
void list_osmesa_devices(std::vector<DeviceInfo>& devices);
}  // namespace detail

}  // namespace radiafit
