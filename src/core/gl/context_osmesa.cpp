// OSMesa: Mesa's software rasterizer behind a function call, no window system, no device.
#define GL_GLEXT_PROTOTYPES  // osmesa.h brings its own gl.h, which would leave out what functions.h names
#include <GL/osmesa.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/wording.h"
#include "gl/context.h"

namespace radiafit::detail {
namespace {

struct OsMesa {
    decltype(&::OSMesaCreateContextAttribs) create = nullptr;
    decltype(&::OSMesaMakeCurrent) make_current = nullptr;
    decltype(&::OSMesaDestroyContext) destroy = nullptr;
    decltype(&::OSMesaGetProcAddress) get_proc_address = nullptr;
    const char* name = "libOSMesa.so.8";

    // Loaded once, never closed: contexts and their functions live in it.
    static const OsMesa* get() {
        static const OsMesa library = [] {
            OsMesa l;
            void* handle = dlopen(l.name, RTLD_NOW | RTLD_LOCAL);
            if (!handle) return l;
            l.make_current = reinterpret_cast<decltype(l.make_current)>(dlsym(handle, "OSMesaMakeCurrent"));
            l.destroy = reinterpret_cast<decltype(l.destroy)>(dlsym(handle, "OSMesaDestroyContext"));
            l.get_proc_address = reinterpret_cast<decltype(l.get_proc_address)>(dlsym(handle, "OSMesaGetProcAddress"));
            if (l.make_current && l.destroy && l.get_proc_address)
                l.create = reinterpret_cast<decltype(l.create)>(dlsym(handle, "OSMesaCreateContextAttribs"));
            return l;
        }();
        return library.create ? &library : nullptr;
    }
};

void* resolve_by_osmesa(const char* name) { return reinterpret_cast<void*>(OsMesa::get()->get_proc_address(name)); }

/// OSMesa draws in software alone, but reads GALLIUM_DRIVER, too, and crashes where that names another driver, such as
/// zink for EGL: while one of these lives, it is a software one's or none.
class SoftwareDriver {
public:
    SoftwareDriver() {
        const char* driver = std::getenv("GALLIUM_DRIVER");
        if (!driver || !*driver || is_software_renderer(driver)) return;
        hidden_ = driver;
        ::unsetenv("GALLIUM_DRIVER");
    }
    ~SoftwareDriver() {
        if (hidden_) ::setenv("GALLIUM_DRIVER", hidden_->c_str(), 1);
    }
    SoftwareDriver(const SoftwareDriver&) = delete;
    SoftwareDriver& operator=(const SoftwareDriver&) = delete;

private:
    std::optional<std::string> hidden_;
};

class OsMesaContext final : public Context {
public:
    explicit OsMesaContext(const ContextOptions& options) : Context(options) {
        const OsMesa* library = OsMesa::get();
        if (!library)
            throw UserError(fmt::format("{0} osmesa needs libOSMesa.so.8: install libosmesa6, or use {0} egl",
                                        option_name("context")));
        if (options.device > 0)
            throw UserError(fmt::format("{} is out of range: {} osmesa has one device, 0 (see {})",
                                        option_name("device"), option_name("context"),
                                        at_command_line("`radiafit devices`", "list_devices()")));
        const SoftwareDriver while_it_is_made;
        // Any core context first; finish_creation() compares its version and can say what it is.
        for (const std::array<int, 2> version : {std::array{4, 5}, std::array{3, 2}}) {
            const int attributes[] = {OSMESA_FORMAT,
                                      OSMESA_RGBA,
                                      OSMESA_DEPTH_BITS,
                                      0,
                                      OSMESA_STENCIL_BITS,
                                      0,
                                      OSMESA_PROFILE,
                                      OSMESA_CORE_PROFILE,
                                      OSMESA_CONTEXT_MAJOR_VERSION,
                                      version[0],
                                      OSMESA_CONTEXT_MINOR_VERSION,
                                      version[1],
                                      0};
            context_ = library->create(attributes, nullptr);
            if (context_) break;
        }
        if (!context_)
            throw UserError(fmt::format("OSMesa gives no OpenGL 4.5 core context: update Mesa, or use {} egl",
                                        option_name("context")));
        finish_creation(resolve_by_osmesa, "OSMesa");
    }
    ~OsMesaContext() override {
        leave();
        if (context_) OsMesa::get()->destroy(context_);
    }

private:
    void bind() override {
        if (!OsMesa::get()->make_current(context_, pixel_.data(), GL_UNSIGNED_BYTE, 1, 1))
            throw SystemError("OSMesaMakeCurrent failed");
    }

    void unbind() override { OsMesa::get()->make_current(nullptr, nullptr, 0, 0, 0); }

    OSMesaContext context_ = nullptr;
    std::array<uint8_t, 4> pixel_{};  // the window that OSMesa insists on; everything is drawn into textures
};

}  // namespace

std::unique_ptr<Context> create_osmesa_context(const ContextOptions& options) {
    return std::make_unique<OsMesaContext>(options);
}

void list_osmesa_devices(std::vector<DeviceInfo>& devices) {
    if (OsMesa::get()) devices.push_back({ContextKind::osmesa, 0, true, "OSMesa (software)"});
}

}  // namespace radiafit::detail
