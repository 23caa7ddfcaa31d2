// EGL without a window system: the device platform by index, or Mesa's surfaceless platform.
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <vector>

#include "base/error.h"
#include "base/wording.h"
#include "gl/context.h"
#include "gl/driver_advice.h"

namespace radiafit::detail {
namespace {

struct Egl {
    PFNEGLGETPROCADDRESSPROC get_proc_address = nullptr;
    PFNEGLQUERYSTRINGPROC query_string = nullptr;
    PFNEGLINITIALIZEPROC initialize = nullptr;
    PFNEGLBINDAPIPROC bind_api = nullptr;
    PFNEGLCHOOSECONFIGPROC choose_config = nullptr;
    PFNEGLCREATECONTEXTPROC create_context = nullptr;
    PFNEGLDESTROYCONTEXTPROC destroy_context = nullptr;
    PFNEGLMAKECURRENTPROC make_current = nullptr;
    PFNEGLGETERRORPROC get_error = nullptr;
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display = nullptr;
    PFNEGLQUERYDEVICESEXTPROC query_devices = nullptr;             // may be missing
    PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string = nullptr;  // may be missing
    PFNEGLQUERYDEVICEATTRIBEXTPROC query_device_attrib = nullptr;  // may be missing
    std::string client_extensions;

    // Loaded once, never closed: displays, contexts and their functions live in it.
    static const Egl* get() {
        static const Egl library = load();
        return library.get_platform_display ? &library : nullptr;
    }

private:
    static Egl load() {
        Egl l;
        void* handle = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
        if (!handle) return l;
        auto symbol = [&]<class F>(F& pointer, const char* name) {
            pointer = reinterpret_cast<F>(dlsym(handle, name));
            return pointer != nullptr;
        };
        if (!symbol(l.get_proc_address, "eglGetProcAddress") || !symbol(l.query_string, "eglQueryString") ||
            !symbol(l.initialize, "eglInitialize") || !symbol(l.bind_api, "eglBindAPI") ||
            !symbol(l.choose_config, "eglChooseConfig") || !symbol(l.create_context, "eglCreateContext") ||
            !symbol(l.destroy_context, "eglDestroyContext") || !symbol(l.make_current, "eglMakeCurrent") ||
            !symbol(l.get_error, "eglGetError"))
            return l;
        if (const char* text = l.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS)) l.client_extensions = text;
        auto extension = [&]<class F>(F& pointer, const char* name) {
            pointer = reinterpret_cast<F>(l.get_proc_address(name));
        };
        extension(l.query_devices, "eglQueryDevicesEXT");
        extension(l.query_device_string, "eglQueryDeviceStringEXT");
        extension(l.query_device_attrib, "eglQueryDeviceAttribEXT");
        extension(l.get_platform_display, "eglGetPlatformDisplayEXT");
        return l;
    }
};

void* resolve_by_egl(const char* name) { return reinterpret_cast<void*>(Egl::get()->get_proc_address(name)); }

bool has_extension(const char* list, const char* name) {
    for (const char* at = list ? std::strstr(list, name) : nullptr; at; at = std::strstr(at + 1, name)) {
        const char end = at[std::strlen(name)];
        if ((at == list || at[-1] == ' ') && (end == ' ' || end == 0)) return true;
    }
    return false;
}

struct EglDevice {
    EGLDeviceEXT handle;
    bool software, cuda;
    std::string description;
};

std::vector<EglDevice> egl_devices(const Egl& egl) {
    std::vector<EglDevice> result;
    if (!egl.query_devices || !egl.query_device_string) return result;
    EGLDeviceEXT handles[64];
    EGLint count = 0;
    if (!egl.query_devices(64, handles, &count)) return result;
    for (EGLint i = 0; i < count; ++i) {
        const char* extensions = egl.query_device_string(handles[i], EGL_EXTENSIONS);
        EglDevice device{handles[i], has_extension(extensions, "EGL_MESA_device_software"),
                         has_extension(extensions, "EGL_NV_device_cuda"), ""};
        device.description = device.software ? "software rasterizer" : device.cuda ? "NVIDIA GPU" : "GPU";
        EGLAttrib number = 0;
        if (device.cuda && egl.query_device_attrib && egl.query_device_attrib(handles[i], EGL_CUDA_DEVICE_NV, &number))
            device.description += fmt::format(", CUDA device {}", number);
        if (has_extension(extensions, "EGL_EXT_device_drm"))
            if (const char* file = egl.query_device_string(handles[i], EGL_DRM_DEVICE_FILE_EXT))
                device.description += fmt::format(" at {}", file);
        result.push_back(device);
    }
    return result;
}

/// To end a message with: what may keep OpenGL from a graphics chip that is there.
std::string chip_advice() {
    const std::string advice = look_for_chip().advice;
    return advice.empty() ? "" : "; " + advice;
}

class EglContext final : public Context {
public:
    explicit EglContext(const ContextOptions& options) : Context(options) {
        const Egl* egl = Egl::get();
        if (!egl)
            throw UserError(fmt::format("{0} egl needs libEGL.so.1: install libegl1, or use {0} osmesa{1}",
                                        option_name("context"), chip_advice()));
        const std::vector<EglDevice> devices = egl_devices(*egl);
        if (options.device >= static_cast<int>(devices.size())) {
            std::string list;
            for (size_t i = 0; i < devices.size(); ++i) list += fmt::format(" {} ({})", i, devices[i].description);
            throw UserError(fmt::format("{} {} is out of range: EGL has{} (see {}){}", option_name("device"),
                                        options.device, list.empty() ? " no devices" : list,
                                        at_command_line("`radiafit devices`", "list_devices()"),
                                        list.empty() ? chip_advice() : ""));
        }
        if (options.device >= 0) {
            if (!open(*egl, EGL_PLATFORM_DEVICE_EXT, devices[options.device].handle))
                throw UserError(fmt::format("{0} {1} ({2}) gives no OpenGL core context: choose another {0}",
                                            option_name("device"), options.device,
                                            devices[options.device].description));
        } else {
            open_any(*egl, devices);
        }
        finish_creation(resolve_by_egl, "EGL");
    }
    ~EglContext() override {
        leave();
        if (context_) Egl::get()->destroy_context(display_, context_);
        // The display is not terminated: every context on the same platform shares it.
    }

private:
    // GPUs first (those that CUDA sees before others), then surfaceless, which may be a software rasterizer.
    void open_any(const Egl& egl, const std::vector<EglDevice>& devices) {
        for (const bool cuda : {true, false})
            for (const EglDevice& device : devices)
                if (!device.software && device.cuda == cuda && open(egl, EGL_PLATFORM_DEVICE_EXT, device.handle))
                    return;
        if (open(egl, EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY)) return;
        for (const EglDevice& device : devices)
            if (device.software && open(egl, EGL_PLATFORM_DEVICE_EXT, device.handle)) return;
        throw UserError(
            fmt::format("EGL gives no OpenGL core context without a window system: install Mesa, or use {} osmesa{}",
                        option_name("context"), chip_advice()));
    }

    bool open(const Egl& egl, EGLenum platform, void* native) {
        display_ = egl.get_platform_display(platform, native, nullptr);
        if (display_ == EGL_NO_DISPLAY || !egl.initialize(display_, nullptr, nullptr)) return false;
        if (!egl.bind_api(EGL_OPENGL_API)) return false;
        const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        if (!egl.choose_config(display_, config_attributes, &config, 1, &count) || count == 0) config = nullptr;
        // Any core context in the end; finish_creation() compares its version and can say what it is. One that tells of
        // resets first (Context::check_device), which not every driver knows how to make.
        for (const std::array<EGLint, 2> version : {std::array<EGLint, 2>{4, 5}, std::array<EGLint, 2>{3, 2}})
            for (const bool tells_resets : {true, false}) {
                std::vector<EGLint> attributes = {EGL_CONTEXT_MAJOR_VERSION,       version[0],
                                                  EGL_CONTEXT_MINOR_VERSION,       version[1],
                                                  EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
                if (tells_resets)
                    attributes.insert(attributes.end(),
                                      {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
                if (options_.debug) attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_DEBUG, EGL_TRUE});
                attributes.push_back(EGL_NONE);
                context_ = egl.create_context(display_, config, EGL_NO_CONTEXT, attributes.data());
                if (context_ != EGL_NO_CONTEXT) return true;
            }
        return false;
    }

    void bind() override {
        const Egl* egl = Egl::get();
        if (!egl->bind_api(EGL_OPENGL_API) || !egl->make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
            throw SystemError(fmt::format("eglMakeCurrent failed (error 0x{:04x})", egl->get_error()));
    }

    void unbind() override { Egl::get()->make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<Context> create_egl_context(const ContextOptions& options) {
    return std::make_unique<EglContext>(options);
}

void list_egl_devices(std::vector<DeviceInfo>& devices) {
    const Egl* egl = Egl::get();
    if (!egl) return;
    int index = 0;
    for (const EglDevice& device : egl_devices(*egl))
        devices.push_back({ContextKind::egl, index++, device.software, device.description});
}

}  // namespace radiafit::detail
