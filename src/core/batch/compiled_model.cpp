#include "batch/compiled_model.h"

#include <fmt/format.h>

#include <iterator>
#include <vector>

#include "batch/embedded_kernel.h"

namespace radiafit::batch {
namespace {

/// Parts of `-ffast-math` that leave sums in their order: by them products with derivatives that are zero go.
constexpr const char* flags[] = {"-std=c++20",         "-O3",
                                 "-march=native",      "-fno-math-errno",
                                 "-fno-trapping-math", "-fno-signed-zeros",
                                 "-ffinite-math-only", "-ffp-contract=fast"};

std::string text_of(const ModelText& model, Precision precision) {
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
    text += fmt::format("using real = radiafit::Jet<radiafit::batch::Wide<{}>, {}>;\n", real, model.parameters.size());
    text += fmt::format("#line 1 \"{}\"\n{}\n", users_text_name, model.text);
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

LibrarySource source_of(const ModelText& model, Precision precision) {
    return {.name = model.name,
            .text = text_of(model, precision),
            .flags = {std::begin(flags), std::end(flags)},
            .files = embedded_kernel(),
            .folders = {"src/core", "shaders"}};
}

}  // namespace

CompiledModel::CompiledModel(const ModelText& text, Precision precision)
    : text_(text), precision_(precision), library_(source_of(text, precision)) {
    storage_bytes_ = library_.find<long long(long long)>("radiafit_storage_bytes");
    solve_ = library_.find<void(const Chunk*, void*)>("radiafit_solve");
    evaluate_ = library_.find<void(const void*, const void*, long long, void*, void*)>("radiafit_evaluate");
}

}  // namespace radiafit::batch
