#include "gl/context.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <utility>

#include "base/cache_folder.h"
#include "base/error.h"
#include "base/program.h"
#include "base/range.h"
#include "base/wording.h"

namespace radiafit {
namespace {

thread_local Context* current_context = nullptr;

// Mesa's shader cache turns 0.7 s of start-up into 0.2. Its default is under the home folder, which may be read-only.
void choose_shader_cache() {
    namespace fs = std::filesystem;
    if (std::getenv("MESA_SHADER_CACHE_DIR") || std::getenv("MESA_SHADER_CACHE_DISABLE")) return;
    std::error_code failed;
    fs::path cache = cache_folder();
    if (cache.empty()) cache = fs::temp_directory_path(failed) / "radiafit";
    if (failed) return;
    const fs::path folder = cache / "shaders";
    fs::create_directories(folder, failed);
    if (!failed) ::setenv("MESA_SHADER_CACHE_DIR", folder.c_str(), 0);
}

// Where none is asked for: RADIAFIT_OPENGL=osmesa, or the number of one of EGL's devices.
void choose_by_environment(ContextOptions& options) {
    const char* asked = std::getenv("RADIAFIT_OPENGL");
    if (!asked || !*asked || options.kind != ContextKind::egl || options.device >= 0) return;
    if (asked == std::string_view("osmesa"))
        options.kind = ContextKind::osmesa;
    else
        options.device = parse_number("RADIAFIT_OPENGL", asked, Range<int>{0, 1023, "or osmesa"});
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
    // Drivers that pass commands on (virgl, zink, D3D12) name in brackets what draws in the end.
    std::string name = renderer;
    for (char& c : name) c = char(std::tolower(static_cast<unsigned char>(c)));
    for (const char* software :
         {"llvmpipe", "lavapipe", "softpipe", "swrast", "swr (", "swiftshader", "microsoft basic render driver"})
        if (name.find(software) != std::string::npos) return true;
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
    choose_by_environment(resolved);
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
    if (options_.kind == ContextKind::osmesa) renderer_ += ", OSMesa";  // which rows tell from EGL's
    version_ = gl_string(functions_, GL_VERSION);
    software_ = is_software_renderer(renderer_);

    functions_.GetIntegerv(GL_MAX_TEXTURE_SIZE, &limits_.texture_size);
    limits_.texture_size =
        std::min(limits_.texture_size, 1 << 14);  // passes pack a texel's place in 14 bits a coordinate
    functions_.GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &limits_.texture_layers);
    functions_.GetIntegerv(GL_MAX_DRAW_BUFFERS, &limits_.draw_buffers);
    functions_.GetIntegerv(GL_MAX_TEXTURE_IMAGE_UNITS, &limits_.texture_units);
    functions_.GetIntegerv(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS, &limits_.fragment_ssbos);
    functions_.GetIntegerv(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, &limits_.compute_ssbos);
    // Every block has a binding of its own, and bindings may be fewer.
    int bindings = 0;
    functions_.GetIntegerv(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, &bindings);
    limits_.fragment_ssbos = std::min(limits_.fragment_ssbos, bindings);
    limits_.compute_ssbos = std::min(limits_.compute_ssbos, bindings);
    functions_.GetIntegerv(GL_MAX_VARYING_COMPONENTS, &limits_.varying_components);
    GLint64 value = 0;
    functions_.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &value);
    limits_.ssbo_bytes = value;
    functions_.GetInteger64v(GL_MAX_TEXTURE_BUFFER_SIZE, &value);
    limits_.texture_buffer_texels = value;

    int shared = 0;
    functions_.GetIntegerv(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, &shared);
    limits_.shared_bytes = shared;

    functions_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    functions_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (options_.debug) {
        functions_.Enable(GL_DEBUG_OUTPUT);
        functions_.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        functions_.DebugMessageCallback(collect_message, &debug_message_);
        detail::check_gl_calls = true;
    }
}

size_t Context::group_size(size_t usual, size_t shared_bytes_each, size_t shared_bytes) const {
    constexpr size_t sizes[] = {128, 64, 32, 8};
    size_t wanted = software_ ? 8 : usual;
    if (const char* asked = std::getenv("RADIAFIT_GROUP_SIZE"); asked && *asked) {
        const auto found = std::ranges::find(sizes, asked, [](size_t size) { return std::to_string(size); });
        if (found == std::end(sizes))
            throw UserError(fmt::format("RADIAFIT_GROUP_SIZE={}: choose 8, 32, 64 or 128", asked));
        wanted = *found;
    }
    for (const size_t size : sizes)
        if (size <= wanted && int64_t(size * shared_bytes_each + shared_bytes) <= limits_.shared_bytes) return size;
    return sizes[3];
}

bool Context::has_extension(std::string_view name) const {
    GLint count = 0;
    functions_.GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; ++i)
        if (name == reinterpret_cast<const char*>(functions_.GetStringi(GL_EXTENSIONS, GLuint(i)))) return true;
    return false;
}

// Errors stay until they are asked for, one of each kind. Running out of memory comes before any other: what was made
// without memory gives further errors.
GLenum Context::take_error() {
    GLenum found = GL_NO_ERROR;
    for (int kind = 0; kind < 16; ++kind) {
        const GLenum error = functions_.GetError.pointer();
        if (error == GL_NO_ERROR) break;
        if (found != GL_OUT_OF_MEMORY) found = error;
        if (error == GL_CONTEXT_LOST) break;  // it says so for ever
    }
    debug_message_.clear();
    return found;
}

void Context::refuse_for_memory(const std::string& what) {
    const std::optional<int64_t> free = free_device_bytes();
    const std::string left = free ? fmt::format(", and {} MB are free", *free / 1000000) : "";
    throw UserError(fmt::format(
        "{}: the device has no room for {}; {} MB of its memory are held by this program{}: choose a smaller "
        "fit, another {}, or cut it by {}",
        renderer_, what, allocated_bytes_ / 1000000, left, option_name("engine"), option_name("memory")));
}

void Context::allocate(const std::string& what, int64_t bytes, const std::function<void()>& make) {
    check_device();
    const bool checked = std::exchange(detail::check_gl_calls, false);
    make();
    detail::check_gl_calls = checked;
    if (const GLenum error = take_error(); error == GL_OUT_OF_MEMORY)
        refuse_for_memory(fmt::format("{}, {} MB", what, bytes / 1000000 + 1));
    else if (error != GL_NO_ERROR)
        throw SystemError(fmt::format("{} refuses {} (error 0x{:04x})", renderer_, what, error));
    allocated_bytes_ += bytes;
    peak_bytes_ = std::max(peak_bytes_, allocated_bytes_);
}

void Context::count_release(int64_t bytes) { allocated_bytes_ -= bytes; }

void Context::check_device() {
    const GLenum reset = functions_.GetGraphicsResetStatus.pointer(), error = take_error();
    if (reset != GL_NO_ERROR || error == GL_CONTEXT_LOST)
        throw SystemError(fmt::format(
            "{}: the device was reset{}, and what it held is lost; run the command again", renderer_,
            reset == GL_GUILTY_CONTEXT_RESET ? ", for a command of this program took too long or went wrong" : ""));
    if (error == GL_OUT_OF_MEMORY) refuse_for_memory("what it drew last");
}

std::optional<int64_t> Context::free_device_bytes() const {
    // Of the two extensions below, in units of 1024 bytes.
    constexpr GLenum nvidia_available_kb = 0x9049, ati_texture_free_kb = 0x87FC;
    GLint kb[4] = {};
    if (has_extension("GL_NVX_gpu_memory_info"))
        functions_.GetIntegerv(nvidia_available_kb, kb);
    else if (has_extension("GL_ATI_meminfo"))
        functions_.GetIntegerv(ati_texture_free_kb, kb);
    else
        return {};
    return int64_t(kb[0]) * 1024;
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

namespace {

std::string how_it_ended(const Ended& ended) {
    if (ended.status == 0) return "";
    if (ended.status == 128 + SIGALRM) return "does not answer";
    const std::string why = ended.status > 128 ? strsignal(ended.status - 128) : fmt::format("status {}", ended.status);
    return fmt::format("crashes ({}){}{}", why, ended.message.empty() ? "" : ": ", single_line(ended.message));
}

}  // namespace

std::vector<DeviceAnswer> ask_each_device(const std::function<std::string(const DeviceInfo&)>& ask) {
    constexpr unsigned patience_s = 60;
    std::vector<DeviceAnswer> answers;
    for (const ContextKind kind : {ContextKind::egl, ContextKind::osmesa}) {
        const Ended listed = run_apart(
            [&] {
                std::vector<DeviceInfo> devices;
                (kind == ContextKind::egl ? detail::list_egl_devices : detail::list_osmesa_devices)(devices);
                std::string lines;
                for (const DeviceInfo& d : devices)
                    lines += fmt::format("{} {} {}\n", d.device, int(d.software), d.description);
                return lines;
            },
            patience_s);
        if (listed.status != 0) answers.push_back({{kind, -1, false, "which"}, "", how_it_ended(listed)});
        std::istringstream lines(listed.output);
        for (DeviceInfo d{.kind = kind};
             lines >> d.device >> d.software && std::getline(lines >> std::ws, d.description);) {
            const Ended ended = run_apart([&] { return ask(d); }, patience_s);
            answers.push_back({d, ended.output, how_it_ended(ended)});
        }
    }
    return answers;
}

std::vector<DeviceInfo> list_devices() {
    std::vector<DeviceInfo> devices;
    detail::list_egl_devices(devices);
    detail::list_osmesa_devices(devices);
    return devices;
}

}  // namespace radiafit
