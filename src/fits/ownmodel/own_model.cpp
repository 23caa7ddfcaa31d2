#include "ownmodel/own_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>

#include "base/compiled_library.h"
#include "base/error.h"
#include "base/read_file.h"
#include "base/text_file.h"
#include "base/wording.h"
#include "cpu/texel_solver.h"
#include "gl/derivative_text.h"
#include "gl/shader_text.h"
#include "ownmodel/embedded_headers.h"

namespace radiafit::fits {
namespace {

namespace fs = std::filesystem;

constexpr const char* text_file = "shaders/own/text.glsl";  // for the compiler

struct Loaded {
    std::string text;
    std::unique_ptr<CompiledLibrary> library;
    const TexelModel* model = nullptr;
};

/// Until the program ends: the models' code is in the libraries.
struct AllLoaded {
    std::mutex mutex;
    std::map<std::string, Loaded> by_name;
};
AllLoaded& loaded() {
    static auto* all = new AllLoaded;
    return *all;
}

void check_name(const fs::path& file, const std::string& name) {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    const auto either = [&](char c) { return letter(c) || (c >= '0' && c <= '9'); };
    if (name.empty() || name.size() > 40 || !letter(name[0]) || !std::ranges::all_of(name, either))
        throw UserError(
            fmt::format("{}: a model is named as its file, by up to 40 letters, digits and _ that begin "
                        "with a letter; rename it",
                        file.string()));
    for (const TexelModel* model : texel_models())
        if (model->name == name)
            throw UserError(
                fmt::format("{}: there is a model {} in the program already; rename the file", file.string(), name));
}

LibrarySource source_of(const std::string& file, const std::string& name, const std::string& text) {
    LibrarySource out{.name = file, .text = "", .flags = {}, .files = embedded_headers(), .folders = {}};
    out.text = fmt::format(
        "#include \"cpu/texel_solvers_of.h\"\n"
        "#include \"model/texel_model_of.h\"\n"
        "#define RADIAFIT_TEXEL_MODEL {0}\n"
        "#define RADIAFIT_TEXEL_FILE \"own/text.glsl\"\n"
        "#include \"model/define_texel_text.h\"\n"
        "extern \"C\" const radiafit::TexelModel* radiafit_texel_model() {{\n"
        "    return new radiafit::TexelModelOf<radiafit::texel_text::{0}<float>>;\n"
        "}}\n"
        "extern \"C\" const radiafit::TexelSolvers* radiafit_texel_solvers() {{\n"
        "    return new radiafit::TexelSolversOf<radiafit::texel_text::{0}<radiafit::Pack>>;\n"
        "}}\n",
        name);
    out.files.push_back({text_file, text});
    out.folders = {"src/core", "shaders"};
    std::istringstream flags(RADIAFIT_KERNEL_FLAGS);
    for (std::string flag; flags >> flag;) out.flags.push_back(flag);
    std::istringstream folders(RADIAFIT_EIGEN);
    for (std::string folder; folders >> folder;) out.flags.insert(out.flags.end(), {"-isystem", folder});
    return out;
}

LoadedModel load(const fs::path& file, const std::string& name, bool trusted) {
    const std::string text = plain_text(read_file(file, "model"), file);
    check_name(file, name);
    const std::scoped_lock lock(loaded().mutex);
    if (const auto found = loaded().by_name.find(name); found != loaded().by_name.end()) {
        if (found->second.text != text)
            throw UserError(
                fmt::format("{}: another text is loaded as {} already, and one program knows one; rename one of them",
                            file.string(), name));
        return {found->second.model};
    }
    const std::string for_compiler = fmt::format("#line 1 \"{}\"\n{}", users_text_name, text);
    const LibrarySource source = source_of(file.string(), name, for_compiler);
    if (!trusted && !CompiledLibrary::is_kept(source))
        throw UserError(fmt::format(
            "{}: the fit's model is a text that was never compiled here; it becomes a part of the program, so read it, "
            "and {}",
            file.string(),
            at_command_line(fmt::format("run `radiafit model {}`", file.parent_path().string()),
                            "load it by its file")));
    const std::string for_opengl = with_derivatives(file.string(), text, shader_file);
    Loaded& own = loaded().by_name[name];
    try {
        own.library = std::make_unique<CompiledLibrary>(source);
        std::unique_ptr<const TexelModel> model(own.library->find<const TexelModel*()>("radiafit_texel_model")());
        std::unique_ptr<const TexelSolvers> solvers(
            own.library->find<const TexelSolvers*()>("radiafit_texel_solvers")());
        own.model = &add_texel_model(std::move(model));
        add_texel_solvers(*own.model, std::move(solvers));
        add_shader(fmt::format("model/{}.glsl", name), for_opengl);
        own.text = text;
    } catch (...) {
        loaded().by_name.erase(name);
        throw;
    }
    return {own.model, own.library->seconds()};
}

}  // namespace

bool is_model_file(const std::string& model) { return model.ends_with(".glsl"); }

LoadedModel load_model(const fs::path& file) { return load(file, file.stem().string(), true); }

LoadedModel load_model_of_fit(const fs::path& folder, const std::string& name, bool trusted) {
    if (!path_exists(folder / model_text_name)) return {};
    return load(folder / model_text_name, name, trusted);
}

std::string text_of_model(const std::string& name) {
    const std::scoped_lock lock(loaded().mutex);
    const auto found = loaded().by_name.find(name);
    return found == loaded().by_name.end() ? "" : found->second.text;
}

}  // namespace radiafit::fits
