#include "batch/compiled_model.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string_view>
#include <vector>

#include "base/atomic_file.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/program.h"
#include "base/read_file.h"
#include "batch/embedded_kernel.h"

namespace radiafit::batch {
namespace {

using std::filesystem::path;

std::string compiler() {
    if (const char* chosen = std::getenv("CXX"); chosen && *chosen && on_path(chosen)) return chosen;
    for (const char* name : {"c++", "g++", "clang++"})
        if (on_path(name)) return name;
    throw UserError(
        "no C++ compiler: a model's text is compiled on this machine; install one, such as Debian's package g++");
}

/// Parts of `-ffast-math` that leave sums in their order: by them products with derivatives that are zero go.
constexpr const char* flags[] = {"-std=c++20",        "-O3",
                                 "-march=native",     "-fPIC",
                                 "-shared",           "-w",
                                 "-fno-math-errno",   "-fno-trapping-math",
                                 "-fno-signed-zeros", "-ffinite-math-only",
                                 "-ffp-contract=fast"};

constexpr const char* name_for_compiler = "model.glsl";  // a file's own name may hold anything

std::string source_of(const ModelText& model, Precision precision) {
    const char* real = precision == Precision::double_precision ? "double" : "float";
    const auto list = [](const std::string& pattern, size_t count, const std::vector<std::string>& names) {
        std::string out;
        for (size_t i = 0; i < count; ++i)
            out += (i ? ", " : "") + fmt::format(fmt::runtime(pattern), fmt::arg("i", i), fmt::arg("name", names[i]));
        return out;
    };
    std::string values;
    for (size_t i = 0; i < model.values.size(); ++i) values += fmt::format("y[{}] = v.{}; ", i, model.values[i]);
    std::string text;
    text +=
        "#include \"batch/kernel/numbers.h\"\n#define SHARED_FN inline\n#define SELECT(c, a, b) real::select(c, a, "
        "b)\n";
    text += "namespace model_text {\n";
    text += fmt::format("using real = radiafit::batch::Jet<radiafit::batch::Wide<{}>, {}>;\n", real,
                        model.parameters.size());
    text += fmt::format("#line 1 \"{}\"\n{}\n", name_for_compiler, model.text);
    text += "#line 1 \"model.cpp\"\n}\n#undef SELECT\n";
    text +=
        fmt::format("namespace {{ struct Model {{\n  static constexpr int terms = {}, parameters = {}, values = {};\n",
                    model.terms.size(), model.parameters.size(), model.values.size());
    text += fmt::format(
        "  using real = model_text::real;\n  [[gnu::always_inline]] static inline void value(const real* p, const "
        "real* t, real* y) {{\n"
        "    const model_text::Values v = model_text::value(model_text::Parameters{{{}}}, model_text::Terms{{{}}});\n  "
        "  {}\n  }}\n}}; }}\n",
        list("p[{i}]", model.parameters.size(), model.parameters), list("t[{i}]", model.terms.size(), model.terms),
        values);
    text += "#include \"batch/kernel/problem_lanes.h\"\n";
    text += fmt::format(
        "using Lanes = radiafit::batch::ProblemLanes<{0}, Model>;\n"
        "extern \"C\" long long radiafit_storage_bytes(long long samples) {{ return Lanes::bytes_for(samples); }}\n"
        "extern \"C\" void radiafit_solve(const radiafit::batch::Chunk* chunk, void* storage) {{ Lanes(*chunk, "
        "storage).run(); }}\n"
        "extern \"C\" void radiafit_evaluate(const {0}* p, const {0}* t, long long samples, {0}* y, {0}* d) {{\n"
        "  radiafit::batch::evaluate_samples<{0}, Model>(p, t, samples, y, d); }}\n",
        real);
    return text;
}

/// The first complaint of a compiler about the text, as "NAME:LINE: ..."; else its first.
std::string complaint_of(const std::string& messages, const std::string& name) {
    const std::string before = std::string(name_for_compiler) + ":";
    std::string first;
    for (size_t begin = 0; begin < messages.size();) {
        const size_t end = std::min(messages.find('\n', begin), messages.size());
        const std::string line = messages.substr(begin, end - begin);
        begin = end + 1;
        const size_t at = line.find("error: ");
        if (at == std::string::npos) continue;
        if (first.empty()) first = line.substr(at + 7);
        if (!line.starts_with(before)) continue;
        return name + ":" + line.substr(before.size(), line.find(':', before.size()) - before.size()) + ": " +
               line.substr(at + 7);
    }
    return name + ": " + (first.empty() ? single_line(messages) : first);
}

/// What -march=native depends on.
std::string instructions() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("flags") || line.starts_with("Features")) return line;
    return "";
}

std::string checksum(const std::string& bytes) {
    return fmt::format("{:016x}", hash_bytes(bytes.data(), bytes.size()));
}

/// A folder of this user's own below the one for temporary files: what is in it is run.
path temporary_folder() {
    const path folder = std::filesystem::temp_directory_path() / fmt::format("radiafit-models-{}", geteuid());
    mkdir(folder.c_str(), 0700);
    struct stat is;
    if (lstat(folder.c_str(), &is) != 0 || !S_ISDIR(is.st_mode) || is.st_uid != geteuid() || (is.st_mode & 022) != 0)
        throw UserError(
            fmt::format("{}: is no folder that only this user may write; remove it, or let XDG_CACHE_HOME name another",
                        folder.string()));
    return folder;
}

/// The library of this key, whose name has the checksum of its bytes, too: one that was cut or has rotted is none.
std::optional<path> kept(const path& folder, const std::string& key) {
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(key + "-") && name.ends_with(".so") &&
            name == fmt::format("{}-{}.so", key, checksum(read_file(entry.path(), "compiled model"))))
            return entry.path();
    }
    return std::nullopt;
}

/// Where to compile: where models are kept, or where nobody may write there, below the folder for temporary files.
std::unique_ptr<UnfinishedFolder> working_folder() {
    try {
        return std::make_unique<UnfinishedFolder>(compiled_models_folder(), "");
    } catch (const UserError&) {
        return std::make_unique<UnfinishedFolder>(temporary_folder(), "");
    }
}

/// Returns the library.
path compile(const ModelText& text, const std::string& source, const std::string& program, const std::string& key) {
    const std::unique_ptr<UnfinishedFolder> work = working_folder();
    if (const auto there = kept(work->path().parent_path(), key)) return *there;
    for (const EmbeddedText& part : embedded_kernel()) {
        const std::string_view file = part.file;
        const path to =
            work->path() / file.substr(std::string_view(file.starts_with("src/") ? "src/core/" : "shaders/").size());
        std::filesystem::create_directories(to.parent_path());
        write_file(to, part.text);
    }
    const path model = work->path() / "model.cpp", made = work->path() / "model.so";
    write_file(model, source);
    std::vector<std::string> command = {program};
    command.insert(command.end(), std::begin(flags), std::end(flags));
    command.insert(command.end(), {"-I", work->path().string(), "-o", made.string(), model.string(), "-lm"});
    const Ended ended = run_program(command);
    if (ended.status != 0) throw UserError(complaint_of(ended.message, text.name));
    sync_to_disk(made);
    const path library =
        work->path().parent_path() / fmt::format("{}-{}.so", key, checksum(read_file(made, "compiled model")));
    std::filesystem::rename(made, library);
    return library;
}

template <class Function>
void find(void* library, const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(dlsym(library, name));
    if (!function) throw SystemError(fmt::format("dlsym {} failed: {}", name, dlerror()));
}

}  // namespace

path compiled_models_folder() {
    const auto given = [](const char* name) {
        const char* x = std::getenv(name);
        return std::string(x ? x : "");
    };
    if (const std::string cache = given("XDG_CACHE_HOME"); !cache.empty()) return path(cache) / "radiafit" / "models";
    if (const std::string home = given("HOME"); !home.empty() && home != "/")
        return path(home) / ".cache" / "radiafit" / "models";
    return temporary_folder();
}

CompiledModel::CompiledModel(const ModelText& text, Precision precision) : text_(text), precision_(precision) {
    const std::string source = source_of(text, precision), program = compiler();
    std::string all = source + program + run_program({program, "-v"}).message + instructions();
    for (const EmbeddedText& part : embedded_kernel()) all += part.text;
    for (const char* flag : flags) all += flag;
    const std::string key = checksum(all);
    std::optional<path> library = kept(compiled_models_folder(), key);
    if (!library) {
        const Stopwatch clock;
        library = compile(text, source, program, key);
        seconds_ = clock.wall_s();
    }
    library_ = dlopen(library->c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library_) throw SystemError(fmt::format("dlopen {} failed: {}", library->string(), dlerror()));
    find(library_, "radiafit_storage_bytes", storage_bytes_);
    find(library_, "radiafit_solve", solve_);
    find(library_, "radiafit_evaluate", evaluate_);
}

CompiledModel::~CompiledModel() {
    if (library_) dlclose(library_);
}

}  // namespace radiafit::batch
