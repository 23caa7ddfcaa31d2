// The problems of a texel-local model, and its parameters, for other people's solvers: docs/problems.md.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/error.h"
#include "cpu/texel_solver.h"
#include "fitting/family.h"
#include "fitting/solvers/solver.h"
#include "gl/shader_text.h"
#include "model/texel_local.h"

namespace radiafit::fits {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* texel_formulas = R"json({
    "samples": "texel t has the samples first[t] <= s < first[t + 1], n[t] of them",
    "model": "value(p; u, v): red, green, blue of a texel with parameters p under light from u seen from v: text is its GLSL, where coefficient k of channel c is parameter 3 k + c and the shape comes behind the coefficients",
    "residual": "r[s] = value(p[t]; u[s], v[s]) - target[s], three channels",
    "data": "E = 1/(2 n[t]) sum over s of weight[s] |r[s]|^2",
    "bounds": "sum over the parameters p that have bounds, with q = p - min(max(p, lower), upper): where q is not 0, 1/2 mu q^2, or printed: mu (p - lower) (p - upper)",
    "objective": "data + bounds, of each texel apart",
    "prediction": "of a sample: value(p[t]; u[s], v[s])"
})json";

/// GLSL of the model's values and derivatives.
std::string text_of(const TexelModel& model) {
    std::istringstream expanded(expand_shader(std::string("model/") + model.name + ".glsl").text);
    std::string text;
    for (std::string line; std::getline(expanded, line);)
        if (!line.starts_with("#line")) text += line + "\n";
    return text;
}

/// body(texel, samples that count, and the views' positions that they are of), texel after texel.
template <class Body>
void for_texels(const TexelProblem& problem, const Body& body) {
    TexelSamples block;
    std::vector<ShadedSample> shaded;
    std::vector<uint32_t> which, images;
    for (uint32_t begin = 0; begin < problem.source.texel_count(); begin += TexelSource::block) {
        problem.source.read(begin, block);
        for (uint32_t t = 0; t + 1 < block.first.size(); ++t) {
            problem.loader.load(begin + t, block.of(t), shaded, &which);
            images.clear();
            for (const uint32_t w : which) images.push_back(block.of(t)[w].image);
            body(shaded, images);
        }
    }
}

/// Returns how many samples there are.
uint64_t write_split(const std::string& split, const TexelProblem& problem, ProblemFolder& out) {
    std::vector<int64_t> first = {0};
    for_texels(problem,
               [&](const auto& shaded, const auto&) { first.push_back(first.back() + int64_t(shaded.size())); });
    const uint64_t samples = uint64_t(first.back());
    out.write(split + "_first", {first.size()}, first, "where each texel's samples begin, and the last ones end");
    auto u =
        out.open<float>(split + "_u", {samples, 3}, "unit direction to the lamp in the texel's frame, z its normal");
    auto v = out.open<float>(split + "_v", {samples, 3}, "unit direction to the camera, likewise");
    auto target = out.open<float>(
        split + "_target", {samples, 3},
        "red, green, blue over the lamp's irradiance, on the curve: a white diffuse texel that faces it is 1");
    auto weight = out.open<float>(split + "_weight", {samples}, "of a sample's squared residuals");
    auto image = out.open<int32_t>(split + "_image", {samples}, "the image that it is of");
    for_texels(problem, [&](const auto& shaded, const auto& images) {
        for (size_t i = 0; i < shaded.size(); ++i) {
            u.write({shaded[i].u.data(), 3});
            v.write({shaded[i].v.data(), 3});
            target.write(shaded[i].target);
            weight.write(shaded[i].weight);
            image.write(int32_t(images[i]));
        }
    });
    u.close();
    v.close();
    target.close();
    weight.close();
    image.close();
    return samples;
}

void describe_model(const TexelModel& model, ProblemFolder& out) {
    out.tell("model", json_string(model.name));
    Json parameters = Json::array();
    for (int i = 0; i < model.parameters; ++i) parameters.push_back(model.parameter_name(i));
    out.tell("parameters", parameters.dump());
}

void describe_objective(const TexelOptions& o, ProblemFolder& out) {
    Json lower = Json::array(), upper = Json::array();
    for (const auto& bounds : o.model->bounds) {
        lower.push_back(are_meant(bounds) ? Json(bounds[0]) : Json());
        upper.push_back(are_meant(bounds) ? Json(bounds[1]) : Json());
    }
    out.tell("objective",
             Json{{"mu", o.mu}, {"lower", lower}, {"upper", upper}, {"printed_bounds", o.mode == Mode::paper}}.dump());
    out.tell("curve", json_string(name_of(o.curve)));
    out.tell("formulas", texel_formulas);
    out.tell("text", json_string(text_of(*o.model)));
}

}  // namespace

void export_texel_problems(const Dataset& dataset, const FitRequest& request, ProblemFolder& out) {
    require_lights(dataset);
    TexelOptions options = request.texel_options();
    const std::vector<uint32_t> training = fitted_views(dataset, request), held_out = judged_views(dataset, request);
    const auto atlas = texel_atlas(dataset, options.surface_side);
    describe_model(*options.model, out);
    out.describe_views(training, held_out);
    describe_objective(options, out);
    {
        const SharedTexels texels = distribute_texels(dataset, request, training);
        const TexelLoader loader(dataset, *atlas, training, options);
        const TexelProblem problem{*texels.source, loader, options};
        require_seen(write_split("training", problem, out) > 0, dataset, request);
        out.write("start", {atlas->texel_count(), uint64_t(options.model->parameters)}, starts_of(problem),
                  "parameters of each texel where our fits begin");
    }
    options.clip_above = options.shadow_below = 0;  // a fit is judged by every pixel
    const SharedTexels texels = distribute_texels(dataset, request, held_out);
    const TexelLoader loader(dataset, *atlas, held_out, options);
    write_split("held_out", {*texels.source, loader, options}, out);
}

void export_parameters(const ReflectanceFit& fit, ProblemFolder& out) {
    const uint64_t n = uint64_t(fit.options.model->parameters);
    describe_model(*fit.options.model, out);
    out.write("texels", {fit.parameters.size() / n, n}, fit.parameters, "parameters of each texel");
}

}  // namespace radiafit::fits
