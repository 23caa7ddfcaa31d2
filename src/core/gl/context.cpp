#include "gl/context.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "base/wording.h"

namespace radiafit {
namespace {

thread_local Context* current_context = nullptr;

// Mesa's shader cache turns 0.7 s of start-up into 0.2. Its default is under the home folder, which may be read-only.
void choose_shader_cache() {
    namespace fs = std::filesystem;
    if (std::getenv("MESA_SHADER_CACHE_DIR") || std::getenv("MESA_SHADER_CACHE_DISABLE")) return;
    std::error_code failed;
    fs::path base;
    if (const char* cache = std::getenv("XDG_CACHE_HOME")) base = cache;
    if (base.empty())
        if (const char* home = std::getenv("HOME")) base = fs::path(home) / ".cache";
    if (base.empty()) base = fs::temp_directory_path(failed);
    if (base.empty()) return;
    const fs::path folder = base / "radiafit" / "shaders";
    fs::create_directories(folder, failed);
    if (!failed) ::setenv("MESA_SHADER_CACHE_DIR", folder.c_str(), 0);
}

std::string gl_string(const GlFunctions& functions, GLenum name) {
    const auto* text = reinterpret_cast<const char*>(functions.GetString(name));
    return text ? text : "";
}

void APIENTRY collect_message(GLenum source, GLenum type, GLuint, GLenum, GLsizei, const GLchar* message,
                              const void* user) {
    // Compilers report through their logs, and warn of what is none of ours.
    if (type != GL_DEBUG_TYPE_ERROR || source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
    *static_cast<std::string*>(const_cast<void*>(user)) += message;
}

}  // namespace

bool is_software_renderer(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "SwiftShader"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

std::string to_string(ContextKind kind) { return kind == ContextKind::egl ? "egl" : "osmesa"; }

ContextKind context_kind_from(const std::string& name) {
    if (name == "egl") return ContextKind::egl;
    if (name == "osmesa") return ContextKind::osmesa;
    throw UserError(fmt::format("unknown context '{}': choose egl or osmesa", name));
}

std::unique_ptr<Context> Context::create(const ContextOptions& options) {
    choose_shader_cache();
    ContextOptions resolved = options;
    const char* debug = std::getenv("RADIAFIT_GL_DEBUG");
    if (debug && debug[0] == '1') resolved.debug = true;
    return resolved.kind == ContextKind::egl ? detail::create_egl_context(resolved)
                                             : detail::create_osmesa_context(resolved);
}

Context::~Context() = default;

void Context::leave() {
    if (current_context != this) return;
    functions_.Finish.pointer();
    unbind();
    current_context = nullptr;
    detail::check_gl_calls = false;
}

void Context::make_current() {
    if (current_context == this) return;
    // Mesa's libraries share one dispatch table per thread: let go of the old context before taking the new one.
    if (current_context) current_context->leave();
    bind();
    current_context = this;
    detail::check_gl_calls = options_.debug;
}

Context& Context::current() {
    if (!current_context) throw SystemError("no OpenGL context is current on this thread");
    return *current_context;
}

void Context::finish_creation(void* (*resolve)(const char*), const std::string& library) {
    if (current_context) current_context->leave();
    bind();
    current_context = this;
    detail::check_gl_calls = false;
    try {
        // The version first: an old context may lack the entry points that load() insists on.
        auto get_string = reinterpret_cast<decltype(&::glGetString)>(resolve("glGetString"));
        auto get_integer = reinterpret_cast<decltype(&::glGetIntegerv)>(resolve("glGetIntegerv"));
        if (!get_string || !get_integer) throw SystemError(library + " has no entry point glGetString");
        int major = 0, minor = 0;
        get_integer(GL_MAJOR_VERSION, &major);
        get_integer(GL_MINOR_VERSION, &minor);
        const int needed = options_.minimum_version;
        if (10 * major + minor < needed) {
            const auto* renderer = reinterpret_cast<const char*>(get_string(GL_RENDERER));
            throw UserError(
                fmt::format("{} ({}) offers OpenGL {}.{}, but {}.{} core is needed: update the driver, or choose "
                            "another {} or {} (see {})",
                            library, renderer ? renderer : "unknown renderer", major, minor, needed / 10, needed % 10,
                            option_name("context"), option_name("device"),
                            at_command_line("`radiafit devices`", "list_devices()")));
        }
        functions_.load(resolve, library);
    } catch (...) {
        unbind();
        current_context = nullptr;
        throw;
    }
    vendor_ = gl_string(functions_, GL_VENDOR);
    renderer_ = gl_string(functions_, GL_RENDERER);
    version_ = gl_string(functions_, GL_VERSION);
    software_ = is_software_renderer(renderer_);

    functions_.GetIntegerv(GL_MAX_TEXTURE_SIZE, &limits_.texture_size);
    functions_.GetIntegerv(GL_MAX_DRAW_BUFFERS, &limits_.draw_buffers);
    functions_.GetIntegerv(GL_MAX_TEXTURE_IMAGE_UNITS, &limits_.texture_units);
    functions_.GetIntegerv(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS, &limits_.fragment_ssbos);
    functions_.GetIntegerv(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, &limits_.compute_ssbos);
    functions_.GetIntegerv(GL_MAX_VARYING_COMPONENTS, &limits_.varying_components);
    GLint64 value = 0;
    functions_.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &value);
    limits_.ssbo_bytes = value;
    functions_.GetInteger64v(GL_MAX_TEXTURE_BUFFER_SIZE, &value);
    limits_.texture_buffer_texels = value;

    functions_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    functions_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (options_.debug) {
        functions_.Enable(GL_DEBUG_OUTPUT);
        functions_.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        functions_.DebugMessageCallback(collect_message, &debug_message_);
        detail::check_gl_calls = true;
    }
}

bool Context::has_extension(std::string_view name) const {
    GLint count = 0;
    functions_.GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; ++i)
        if (name == reinterpret_cast<const char*>(functions_.GetStringi(GL_EXTENSIONS, GLuint(i)))) return true;
    return false;
}

void Context::count_allocation(int64_t bytes) {
    allocated_bytes_ += bytes;
    peak_bytes_ = std::max(peak_bytes_, allocated_bytes_);
}

const GlFunctions& gl() { return Context::current().functions(); }

namespace detail {

thread_local bool check_gl_calls = false;

void after_gl_call(const char* name) {
    Context& context = Context::current();
    GLenum error = context.functions_.GetError.pointer();
    if (error == GL_NO_ERROR && context.debug_message_.empty()) return;
    std::string message;
    message.swap(context.debug_message_);
    throw SystemError(fmt::format("{} failed (error 0x{:04x}): {}", name, error, message));
}

}  // namespace detail

std::vector<DeviceInfo> list_devices() {
    std::vector<DeviceInfo> devices;
    detail::list_egl_devices(devices);
    detail::list_osmesa_devices(devices);
    return devices;
}

}  // namespace radiafit
