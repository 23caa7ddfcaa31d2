#include "gl/shader_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>

#include "base/error.h"
#include "gl/embedded_shaders.h"

namespace radiafit {
namespace {

struct Added {
    std::mutex mutex;
    std::map<std::string, std::function<std::string()>> shaders;
};
Added& added() {
    static Added all;
    return all;
}

// "model/MODEL.glsl" with MODEL defined as lambert: "model/lambert.glsl".
std::string included_file(const std::string& name, const Defines& defines) {
    const std::filesystem::path path(name);
    for (const auto& [macro, value] : defines)
        if (path.stem() == macro) return (path.parent_path() / (value + path.extension().string())).string();
    return name;
}

// Appends `file` line by line. A file is included once.
void append(const std::string& file, const Defines& defines, ShaderText& out) {
    const size_t index = out.files.size();
    const bool stage = index == 0;
    out.files.push_back(file);
    std::istringstream stream(shader_file(file));
    std::string line;
    int number = 0;
    if (!stage) out.text += fmt::format("#line 1 {}\n", index);
    while (std::getline(stream, line)) {
        ++number;
        if (stage && number == 1) {
            out.text += line + "\n";
            for (const auto& [name, value] : defines) out.text += fmt::format("#define {} {}\n", name, value);
            out.text += fmt::format("#line 2 {}\n", index);
            continue;
        }
        const size_t begin = line.find_first_not_of(" \t");
        if (begin != std::string::npos && line.compare(begin, 8, "#include") == 0) {
            const size_t open = line.find('"'), close = line.find('"', open == std::string::npos ? open : open + 1);
            if (open == std::string::npos || close == std::string::npos)
                throw UserError(fmt::format("{}:{}: #include needs a file in quotes", file, number));
            const std::string name = included_file(line.substr(open + 1, close - open - 1), defines);
            if (std::find(out.files.begin(), out.files.end(), name) == out.files.end()) append(name, defines, out);
            out.text += fmt::format("#line {} {}\n", number + 1, index);
            continue;
        }
        out.text += line + "\n";
    }
}

}  // namespace

std::string shader_file(const std::string& file) {
    std::function<std::string()> own;
    {
        const std::scoped_lock lock(added().mutex);
        if (const auto found = added().shaders.find(file); found != added().shaders.end()) own = found->second;
    }
    if (own) return own();
    const char* folder = std::getenv("RADIAFIT_SHADERS");
    if (!folder || !*folder) {
        const auto& all = embedded_shaders();
        const auto found = std::ranges::find(all, file, &EmbeddedText::file);
        if (found == all.end()) throw UserError(fmt::format("{}: no such shader", file));
        return std::string(found->text);
    }
    const std::string path = folder + ("/" + file);
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw UserError(fmt::format("{}: cannot be read; unset RADIAFIT_SHADERS, or complete it", path));
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

void add_shader(const std::string& file, std::function<std::string()> text) {
    const std::scoped_lock lock(added().mutex);
    added().shaders[file] = std::move(text);
}

ShaderText expand_shader(const std::string& file, const Defines& defines) {
    ShaderText result;
    append(file, defines, result);
    return result;
}

}  // namespace radiafit
