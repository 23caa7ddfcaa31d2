#include "base/compiled_library.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <optional>

#include "base/atomic_file.h"
#include "base/cache_folder.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/program.h"
#include "base/read_file.h"

namespace radiafit {
namespace {

using std::filesystem::path;

std::string compiler() {
    if (const char* chosen = std::getenv("CXX"); chosen && *chosen && on_path(chosen)) return chosen;
    for (const char* name : {"c++", "g++", "clang++"})
        if (on_path(name)) return name;
    throw UserError(
        "no C++ compiler: a model's text is compiled on this machine; install one, such as Debian's package g++");
}

/// The first complaint of a compiler about the text, as "NAME:LINE: ..."; else its first.
std::string complaint_of(const std::string& messages, const std::string& name) {
    const std::string before = std::string(users_text_name) + ":";
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
    constexpr std::string_view asserted = "static assertion failed: ";
    if (first.starts_with(asserted)) first.erase(0, asserted.size());
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

/// The same where models are kept, or where they are where nobody may write there.
std::optional<path> kept(const std::string& key) {
    const auto found = kept(compiled_models_folder(), key);
    return found ? found : kept(temporary_folder(), key);
}

/// Where to compile: where models are kept, or where nobody may write there, below the folder for temporary files.
std::unique_ptr<UnfinishedFolder> working_folder() {
    try {
        return std::make_unique<UnfinishedFolder>(compiled_models_folder(), "");
    } catch (const UserError&) {
        return std::make_unique<UnfinishedFolder>(temporary_folder(), "");
    }
}

path trusted_file(const path& folder, const std::string& text) {
    return folder / fmt::format("trusted-{}.glsl", checksum(text));
}

/// By which a library is found again: all that it is made of, but for the compiler, so that it serves without one.
std::string key_of(const LibrarySource& source) {
    std::string all = source.text + instructions();
    for (const EmbeddedText& part : source.files) all += part.text;
    for (const auto& list : {source.flags, source.libraries})
        for (const std::string& one : list) all += one;
    return checksum(all);
}

/// Returns the library.
path compile(const LibrarySource& source, const std::string& program, const std::string& key) {
    const std::unique_ptr<UnfinishedFolder> work = working_folder();
    if (const auto there = kept(work->path().parent_path(), key)) return *there;
    for (const EmbeddedText& part : source.files) {
        const path to = work->path() / part.file;
        std::filesystem::create_directories(to.parent_path());
        write_file(to, part.text);
    }
    for (const std::string& library : source.libraries)
        if (!path_exists(library))
            throw UserError(fmt::format("{}: is no more where it was loaded from; start anew", library));
    const path text = work->path() / "model.cpp", made = work->path() / "model.so";
    write_file(text, source.text);
    std::vector<std::string> command = {"env", "LC_ALL=C", program};  // whose messages are read here
    command.insert(command.end(), source.flags.begin(), source.flags.end());
    for (const std::string& folder : source.folders)
        command.insert(command.end(), {"-I", (work->path() / folder).string()});
    command.insert(command.end(), {"-fPIC", "-shared", "-w", "-o", made.string(), text.string()});
    command.insert(command.end(), source.libraries.begin(), source.libraries.end());
    command.emplace_back("-lm");
    const Ended ended = run_program(command);
    if (ended.status != 0) throw UserError(complaint_of(ended.message, source.name));
    sync_to_disk(made);
    const path library =
        work->path().parent_path() / fmt::format("{}-{}.so", key, checksum(read_file(made, "compiled model")));
    std::filesystem::rename(made, library);
    return library;
}

}  // namespace

path surrounding_library() {
    Dl_info found;
    link_map* map = nullptr;
    static const int here = 0;
    if (dladdr1(&here, &found, reinterpret_cast<void**>(&map), RTLD_DL_LINKMAP) == 0 || !map) return {};
    return *map->l_name ? std::filesystem::absolute(map->l_name) : path();  // the program's is ""
}

bool is_trusted(const std::string& text) {
    const auto holds = [&](const path& folder) {
        const path file = trusted_file(folder, text);
        return path_exists(file) && read_file(file, "model") == text;
    };
    return holds(compiled_models_folder()) || holds(temporary_folder());
}

void trust(const std::string& text) {
    if (is_trusted(text)) return;
    const path folder = compiled_models_folder();
    std::error_code none;
    std::filesystem::create_directories(folder, none);
    try {
        write_file(trusted_file(folder, text), text);
    } catch (const UserError&) {  // nobody may write there
        write_file(trusted_file(temporary_folder(), text), text);
    }
}

path compiled_models_folder() {
    const path cache = cache_folder();
    return cache.empty() ? temporary_folder() : cache / "models";
}

CompiledLibrary::CompiledLibrary(const LibrarySource& source) {
    const std::string key = key_of(source);
    std::optional<path> library = kept(key);
    if (!library) {
        const Stopwatch clock;
        library = compile(source, compiler(), key);
        seconds_ = clock.wall_s();
    }
    library_ = dlopen(library->c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library_) {
        const std::string why = dlerror();
        if (why.find("undefined symbol") != std::string::npos && source.libraries.empty())
            throw UserError(fmt::format(
                "{}: this program shows its functions to no library; fit it by the program radiafit", source.name));
        throw SystemError(fmt::format("dlopen {} failed: {}", library->string(), why));
    }
}

CompiledLibrary::~CompiledLibrary() {
    if (library_) dlclose(library_);
}

void* CompiledLibrary::symbol(const char* name) const {
    void* found = dlsym(library_, name);
    if (!found) throw SystemError(fmt::format("dlsym {} failed: {}", name, dlerror()));
    return found;
}

}  // namespace radiafit
