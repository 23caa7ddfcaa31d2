#include "ownmodel/own_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <sstream>

#include "base/compiled_library.h"
#include "base/error.h"
#include "base/instructions.h"
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
    const auto& texts = embedded_headers();
    if (std::ranges::any_of(
            texts, [&](const EmbeddedText& t) { return t.file == fmt::format("shaders/model/{}.glsl", name); }))
        throw UserError(fmt::format("{}: the program has a text {} itself; rename the file", file.string(), name));
}

/// Whether basis function k has other values where the shape is another.
bool depends_on_shape(const TexelModel& m, int k) {
    std::vector<float> p(size_t(m.parameters));
    std::vector<double> columns(size_t(m.columns()));
    for (const float z : {0.3f, 0.6f, 0.95f}) {
        const float r = std::sqrt(1 - z * z);
        std::vector<double> values;
        for (const double share : {0.2, 0.5, 0.8}) {
            for (int i = 0; i < m.shape; ++i) {
                const auto [lowest, highest] = m.bounds[size_t(3 * m.basis + i)];
                const double low = std::max(lowest, -4.0), high = std::max(low, std::min(highest, 4.0));
                p[size_t(3 * m.basis + i)] = float(low + share * (high - low));
            }
            m.columns(p, {r, 0, z}, {0.6f * r, -0.8f * r, z}, columns);
            values.push_back(columns[size_t(k)]);
        }
        if (values[0] != values[1] || values[1] != values[2]) return true;
    }
    return false;
}

/// Of tables that compilers take as they are.
void check(const fs::path& file, const TexelModel& m) {
    const auto refuse = [&](const std::string& what) { throw UserError(fmt::format("{}: {}", file.string(), what)); };
    std::set<std::string> names = {"shape", "status", "problems", "error_bars"};  // other maps of a fit
    for (const auto& list : {m.coefficient_names, m.shape_names})
        for (const std::string& name : list) {
            const auto plain = [](char c) { return std::isalnum(uint8_t(c)) || c == '_'; };
            if (name.empty() || !std::ranges::all_of(name, plain))
                refuse(fmt::format("a coefficient or a number of the shape is named '{}': take letters, digits and _",
                                   name));
            if (!names.insert(name).second)
                refuse(fmt::format("two maps of a fit would be named {}; rename one", name));
        }
    for (int i = 0; i < m.parameters; ++i)
        if (const auto& [lowest, highest] = m.bounds[size_t(i)]; !(lowest <= highest))
            refuse(fmt::format("the bounds of {} are {} and {}: give the lowest and the highest value",
                               m.parameter_name(i), lowest, highest));
    for (const auto& start : m.starts)
        for (size_t i = 0; i < start.size(); ++i)
            if (const auto& [lowest, highest] = m.bounds[size_t(3 * m.basis) + i];
                !(start[i] >= lowest && start[i] <= highest))
                refuse(fmt::format("a start of {} is {}, not within its bounds {} and {}", m.shape_names[i], start[i],
                                   lowest, highest));
    if (m.diffuse && (*m.diffuse < 0 || *m.diffuse >= m.basis))
        refuse(fmt::format("diffuse_coefficient is {}, of {} basis functions", *m.diffuse, m.basis));
    constexpr int most_shapes = 32;  // loops of OpenGL's compilers are this long where they are unrolled
    if (m.shape > most_shapes) refuse(fmt::format("SHAPE_COUNT is {}; {} at most", m.shape, most_shapes));
    constexpr int most_columns = 64;  // squares of them lie on the stack, eight texels at a time
    if (m.columns() > most_columns)
        refuse(fmt::format(
            "{} basis functions and {} x {} derivatives of those that depend on the shape are {} numbers; {} at most",
            m.basis, m.shaped, m.shape, m.columns(), most_columns));
    for (int k = 0; k < m.basis - m.shaped && m.shape > 0; ++k)
        if (depends_on_shape(m, k))
            refuse(fmt::format("{} depends on the shape; by SHAPED_COUNT {}", m.coefficient_names[size_t(k)],
                               m.shaped == 1 ? "the last basis function alone does"
                                             : fmt::format("the last {} basis functions do", m.shaped)));
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
    out.flags.push_back(fmt::format("-DRADIAFIT_RUNS_AVX512={:d}", run_avx512()));
    if (const fs::path library = surrounding_library(); !library.empty()) out.libraries = {library.string()};
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
    if (!trusted && !is_trusted(text))
        throw UserError(fmt::format(
            "{}: the fit's model is a text that was never compiled here; it becomes a part of the program, so read it, "
            "and {}",
            file.string(),
            at_command_line(fmt::format("run `radiafit model {}`", file.parent_path().string()),
                            "have the program's command model compile it")));
    Loaded& own = loaded().by_name[name];
    try {
        own.library = std::make_unique<CompiledLibrary>(source);
        std::unique_ptr<const TexelModel> model(own.library->find<const TexelModel*()>("radiafit_texel_model")());
        check(file, *model);
        std::unique_ptr<const TexelSolvers> solvers(
            own.library->find<const TexelSolvers*()>("radiafit_texel_solvers")());
        if (trusted) trust(text);  // it may throw: before others have the model
        own.model = model.get();
        own.text = text;
        add_shader(fmt::format("model/{}.glsl", name), [=, from = file.string(), shaped = std::max(1, model->shaped)] {
            return with_derivatives(from, text, shaped, shader_file);
        });
        add_texel_solvers(*own.model, std::move(solvers));
        add_texel_model(std::move(model));
    } catch (const std::exception& error) {
        const bool users = dynamic_cast<const UserError*>(&error);
        if (own.model) static_cast<void>(own.library.release());  // whose code others have by now
        loaded().by_name.erase(name);
        if (users) throw;
        throw SystemError(fmt::format("{}: {}", file.string(), error.what()));
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
