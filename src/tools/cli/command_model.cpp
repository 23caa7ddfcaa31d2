// model: a texel-local model of one's own, compiled and described.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/read_file.h"
#include "cli/commands.h"
#include "fit/fit_folder.h"
#include "model/texel_local.h"
#include "ownmodel/own_model.h"

namespace radiafit::tools {
namespace {

/// A text, or a fit's folder.
LoadedModel loaded(const std::string& what) {
    if (!folder_exists(what)) return load_model(what);
    const LoadedModel out = load_model_of_fit(what, fitted_model(what), true);
    if (!out.model) throw UserError(fmt::format("{}: its model is a part of the program", what));
    return out;
}

void describe(const std::string& what, bool json) {
    const LoadedModel is = loaded(what);
    const TexelModel& m = *is.model;
    const auto bounds_of = [&](int i) { return m.bounds[size_t(i)]; };
    if (json) {
        nlohmann::ordered_json out{{"name", m.name}, {"compile_s", is.compile_s}, {"terms", m.terms}};
        for (int i = 0; i < m.parameters; ++i)
            out["parameters"].push_back(
                {{"name", m.parameter_name(i)}, {"lowest", bounds_of(i)[0]}, {"highest", bounds_of(i)[1]}});
        out["starts"] = m.starts;
        fmt::print("{}\n", out.dump());
        return;
    }
    const auto line = [](const std::string& name, const std::array<double, 2>& bounds) {
        fmt::print("  {}{}\n", name,
                   bounds[0] == bounds[1] ? fmt::format(", held at {:g}", bounds[0])
                   : are_meant(bounds)    ? fmt::format(", {:g} to {:g}", bounds[0], bounds[1])
                                          : "");
    };
    fmt::print("{}: {}\n", m.name,
               is.compile_s > 0 ? fmt::format("compiled in {:.1f} s, and kept", is.compile_s) : "compiled");
    fmt::print("coefficients, one for each channel:\n");
    for (int k = 0; k < m.basis; ++k) {
        const bool alike = bounds_of(3 * k) == bounds_of(3 * k + 1) && bounds_of(3 * k) == bounds_of(3 * k + 2);
        if (alike) line(m.coefficient_names[size_t(k)], bounds_of(3 * k));
        for (int c = 0; !alike && c < 3; ++c) line(m.parameter_name(3 * k + c), bounds_of(3 * k + c));
    }
    if (m.shape > 0) fmt::print("shape, which the channels share, with {} starts:\n", m.starts.size());
    for (int i = 0; i < m.shape; ++i) line(m.shape_names[size_t(i)], bounds_of(3 * m.basis + i));
}

}  // namespace

void add_model(CommandLine& program) {
    struct Asked {
        std::string model;
        bool json = false;
    };
    auto o = std::make_shared<Asked>();
    CommandLine& command = program.add_command(
        "model", "compile a texel-local model of one's own, and say what it is (docs/texel-models.md)");
    command.add_text("model", o->model, "its text, or the folder of a fit by it").required();
    add_json(command, o->json);
    command.on_run([=] { describe(o->model, o->json); });
}

}  // namespace radiafit::tools
