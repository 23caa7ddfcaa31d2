#include "fitting/fit_request.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/wording.h"
#include "cpu/vertex_options.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"
#include "fitting/solvers/solver.h"
#include "lightbasis/learn_light_basis.h"

namespace radiafit::fits {

FitRequest& FitRequest::set(const std::string& name, const std::string& value) {
    find_fit_option(name).read(*this, value);
    return *this;
}

std::string FitRequest::text(const std::string& name) const { return find_fit_option(name).text(*this); }

std::string FitRequest::json() const {
    std::string all = "{";
    for (const FitOption& o : fit_options()) all += fmt::format("\"{}\":{},", o.name, o.json(*this));
    return all + fmt::format("\"lower\":{},\"upper\":{}}}", model.lower, model.upper);  // of maps: no options
}

void FitRequest::check() const {
    for (const FitOption& o : fit_options())
        if (o.check) o.check(*this);
    const FitFacts facts = facts_of(*this);
    model_options();
    if (texel_model()) texel_options();
    if (texel_model() && facts.most_parameters && texel_model()->parameters > facts.most_parameters)
        throw UserError(fmt::format("{} has {} numbers a texel, where {} fits up to {}: choose {} and {} or {}",
                                    model_name, texel_model()->parameters,
                                    option_name(facts.on_fragment() ? "engine fragment" : "solver " + solver),
                                    facts.most_parameters, option_name("solver stream"), option_name("engine cpu"),
                                    option_name("engine compute")));
    const bool own_sides = texels_per_pixel > 0 || model.sides;
    if (own_sides && (facts.streams_images() || (facts.distributes() && distributor == DistributorKind::gl)))
        throw UserError(
            fmt::format("where OpenGL distributes, all surface maps have one side; leave out {}, {}, {} or {}",
                        option_name("texels-per-pixel"), option_name("engine fragment"),
                        option_name("samples redistributed"), option_name("distributor gl")));
    if (lacks_engine())
        throw UserError(fmt::format("{} does not fit {}; choose {} or {}", option_name("engine fragment"),
                                    family_of(*this).name, option_name("engine cpu"), option_name("engine compute")));
    if (facts.texel_local() && facts.on_fragment() && value_curve() != ValueCurve::linear)
        throw UserError(fmt::format("{} fits light itself; choose {} or {}, or leave out {}",
                                    option_name("engine fragment"), option_name("engine cpu"),
                                    option_name("engine compute"), option_name("curve")));
    if (surface == SurfaceLookup::linear && facts.streams_images())
        throw UserError(
            fmt::format("{} fits colours at texels' centres, but where OpenGL distributes a texel takes a pixel; "
                        "choose {}, or leave out {} or {}",
                        option_name("surface linear"), option_name("surface nearest"), option_name("engine fragment"),
                        option_name("samples redistributed")));
    if (facts.levenberg_marquardt() && !facts.has_normal_equations())
        throw UserError("optimizer lm fits texel-local models on the CPU; choose cg or sd, or --engine cpu");
}

/// The paper gives no weight. At 1 the jump of its penalty's gradient at the bound (Section 3.1: a - b, here -16)
/// dwarfs the data term's and stalls conjugate gradients; 1e-4 is on a par with it.
float FitRequest::bounds_weight() const { return !(mu < 0) ? float(mu) : mode == Mode::paper ? 1e-4f : 1.0f; }

ValueCurve FitRequest::value_curve() const {
    return curve.value_or(family_of(*this).kind == ModelKind::by_light ? LightBasisOptions().curve
                                                                       : TexelOptions().curve);
}

Rule FitRequest::rule() const {
    const Method& method = optimizer ? *optimizer : methods[0];
    return mode == Mode::paper ? method.paper : method.modern;
}

OptimizerOptions FitRequest::optimizer_options() const {
    return {.rule = rule(),
            .iterations = iterations,
            .stop_residual = float(stop_residual),
            .stop_output_change = float(stop_output_change),
            .history = history,
            .learning_rate = float(learning_rate),
            .left_out = left_out,
            .first_step = first_step};
}

VertexSolverOptions FitRequest::vertex_solver_options() const {
    return {.optimizer = optimizer_options(), .deflate = deflate, .seed = seed, .journal = journal.get()};
}

LfmOptions FitRequest::model_options() const {
    LfmOptions options = model;
    options.mode = mode;
    options.mu = bounds_weight();
    check_options(options);
    return options;
}

TexelOptions FitRequest::texel_options() const {
    TexelOptions options;
    options.model = texel_model();
    options.curve = value_curve();
    options.surface_side = model.surface_side;
    options.mode = mode;
    options.mu = bounds_weight();
    options.clip_above = clip_above;
    options.shadow_below = shadow_below;
    options.loss = model.loss;
    check_options(options);
    return options;
}

FragmentOptions FitRequest::fragment_options() const {
    FragmentOptions options;
    options.passes = passes;
    options.storage = storage;
    options.sums = sums;
    options.cull = cull;
    const StreamOptions stream = stream_options();
    options.keep_on_device = stream.keep_on_device;
    options.source = stream.source;
    options.space = stream.space;
    return options;
}

StreamOptions FitRequest::stream_options() const {
    return {.source = source == ImageSource::memory      ? StreamSource::memory
                      : source == ImageSource::disk_cold ? StreamSource::disk_cold
                                                         : StreamSource::disk,  // once, where they stay on the device
            .keep_on_device = source == ImageSource::device,
            .space = space};
}

bool FitRequest::has_prior() const { return prior != PriorKind::none && facts_of(*this).has_prior(); }

bool FitRequest::redistributes() const { return facts_of(*this).redistributes(); }

bool FitRequest::on_engine(EngineKind kind) const { return facts_of(*this).engine == kind; }

bool FitRequest::lacks_engine() const {
    const ModelKind kind = family_of(*this).kind;
    return on_fragment_engine() && (kind == ModelKind::by_view || kind == ModelKind::by_light);
}

std::string FitRequest::label() const {
    const FitFacts facts = facts_of(*this);
    const std::string by = facts.on_engine ? "" : solver + "-";
    if (facts.ceres) return by + ceres;
    if (!facts.optimizer) return solver;
    return by + text("optimizer") + (levenberg_marquardt() ? "" : "-" + text("mode"));
}

}  // namespace radiafit::fits
