#include "app/choices.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/choose.h"
#include "app/limits.h"
#include "app/solver.h"
#include "base/error.h"

namespace radiafit {
namespace {

/// For a table whose entries have a name: throws UserError if none has this one.
void check_name(const char* what, const std::string& name, const auto& table) {
    std::vector<std::string> names;
    for (const auto& entry : table) names.emplace_back(entry.name);
    if (std::find(names.begin(), names.end(), name) == names.end()) reject_name(what, name, names);
}

Mode choose_mode(const std::string& name) {
    return choose<Mode>("mode", name, {{"paper", Mode::paper}, {"modern", Mode::modern}});
}

/// The paper gives no weight. At 1 the jump of its penalty's gradient at the bound (Section 3.1: a - b, here -16)
/// dwarfs the data term's and stalls conjugate gradients; 1e-4 is on a par with it.
float bounds_weight(double mu, Mode mode) { return !(mu < 0) ? float(mu) : mode == Mode::paper ? 1e-4f : 1.0f; }

}  // namespace

DistributorChoice choose_distributor(const std::string& name) {
    return choose<DistributorChoice>("distributor", name,
                                     {{"cpu", DistributorChoice::cpu}, {"gl", DistributorChoice::gl}});
}
TargetSpace choose_space(const std::string& name) {
    return choose<TargetSpace>("space", name, {{"stored", TargetSpace::stored}, {"linear", TargetSpace::linear}});
}
StreamSource choose_source(const std::string& name) {
    return choose<StreamSource>(
        "source", name,
        {{"disk", StreamSource::disk},
         {"disk-cold", StreamSource::disk_cold},
         {"memory", StreamSource::memory},
         {"device", StreamSource::disk}});  // read once, and kept there: FragmentOptions::resident
}

void check_engine(const std::string& name) { choose<int>("engine", name, {{"cpu", 0}, {"fragment", 1}}); }

RecordKind choose_record(const std::string& name) {
    return choose<RecordKind>("record", name, {{"compact", RecordKind::compact}, {"full", RecordKind::full}});
}

Passes choose_passes(const std::string& name) {
    return choose<Passes>("passes", name, {{"paper", Passes::paper}, {"combined", Passes::combined}});
}
Storage choose_storage(const std::string& name) {
    return choose<Storage>(
        "storage", name, {{"fp32", Storage::fp32}, {"fp16", Storage::fp16}, {"fp16-truncate", Storage::fp16_truncate}});
}
Sums choose_sums(const std::string& name) {
    return choose<Sums>("sums", name, {{"fp32", Sums::fp32}, {"fp16", Sums::fp16}});
}

ContextOptions context_options(const FitRequest& request) {
    ContextOptions options;
    options.kind = context_kind_from(request.context);
    options.device = request.device;
    return options;
}

FragmentOptions fragment_options(const FitRequest& request) {
    FragmentOptions options;
    options.passes = choose_passes(request.passes);
    options.storage = choose_storage(request.storage);
    options.sums = choose_sums(request.sums);
    options.source = choose_source(request.source);
    options.resident = request.source == "device";
    options.space = choose_space(request.space);
    return options;
}

Rule FitRequest::rule() const {
    const bool descent = choose<bool>("optimizer", optimizer, {{"cg", false}, {"sd", true}, {"lm", false}});
    return descent ? Rule::steepest_descent : choose_mode(mode) == Mode::paper ? Rule::cg_paper : Rule::cg_modern;
}

OptimizerOptions FitRequest::optimizer_options() const {
    return {.rule = rule(),
            .iterations = iterations,
            .stop_residual = float(stop_residual),
            .stop_output_change = float(stop_output_change)};
}

uint64_t FitRequest::memory_bytes() const {
    size_t end = 0;
    double value = 0;
    try {
        value = std::stod(memory, &end);
    } catch (const std::exception&) {
    }
    static constexpr std::string_view units = "KMG";
    const std::string unit = memory.substr(end);
    const size_t power = unit.empty() ? 0 : units.find(unit) + 1;
    const double bytes = value * double(uint64_t(1) << (10 * std::min(power, units.size())));
    const bool known_unit = unit.empty() || (unit.size() == 1 && power > 0);
    if (!known_unit || !(bytes >= 1 && bytes < 1e18))
        throw UserError("memory '" + memory + "': give bytes, such as 64M or 2G");
    return uint64_t(bytes);
}

LfmOptions FitRequest::model_options() const {
    LfmOptions options = model;
    options.mode = choose_mode(mode);
    options.mu = bounds_weight(mu, options.mode);
    options.lookup = choose<ViewLookup>("view look-up", view,
                                        {{"bilinear", ViewLookup::bilinear}, {"nearest", ViewLookup::nearest}});
    check_options(options);
    return options;
}

TexelOptions FitRequest::texel_options() const {
    TexelOptions options;
    options.model = find_texel_model(kind);
    if (!options.model) {
        std::vector<std::string> names = {"lfm"};
        for (const TexelModel* known : texel_models()) names.emplace_back(known->name);
        reject_name("model", kind, names);
    }
    options.surface_side = model.surface_side;
    options.mode = choose_mode(mode);
    options.mu = bounds_weight(mu, options.mode);
    options.clip_above = clip_above;
    options.shadow_below = shadow_below;
    check_options(options);
    return options;
}

std::string FitRequest::label() const {
    const std::string rule = levenberg_marquardt() ? optimizer : optimizer + "-" + mode;
    if (solver == "stream") return rule;
    if (solver == "ceres") return texel_local() ? solver : "ceres-" + ceres;
    return solver == "two-step" ? "two-step-" + rule : solver;
}

void FitRequest::check() const {
    check_name("solver", solver, solvers());
    check_engine(engine);
    choose_passes(passes);
    choose_storage(storage);
    choose_sums(sums);
    choose_distributor(distributor);
    choose_space(space);
    choose_source(source);
    choose_record(record);
    check_name("ceres setting", ceres, ceres_settings());
    context_kind_from(context);
    rule();
    memory_bytes();
    model_options();
    if (texel_local()) texel_options();
    if (levenberg_marquardt() && (!texel_local() || (solver == "stream" && engine != "cpu")))
        throw UserError("optimizer lm fits texel-local models on the CPU; choose cg or sd, or --engine cpu");
    require("iterations", iterations, limits::iterations);
    require("validation", validation, limits::validation);
    if (validation == 1) throw UserError(fmt::format("validation = 1: {}", advice(limits::validation)));
    require("refills", refills, limits::refills);
    require("stop-residual", stop_residual, limits::threshold);
    require("stop-change", stop_output_change, limits::threshold);
    require("device", device, limits::device);
}

std::string FitRequest::json() const {
    const nlohmann::ordered_json object = {
        {"model", kind},
        {"solver", solver},
        {"engine", engine},
        {"optimizer", optimizer},
        {"mode", mode},
        {"passes", passes},
        {"storage", storage},
        {"sums", sums},
        {"distributor", distributor},
        {"source", source},
        {"view", view},
        {"space", space},
        {"context", context},
        {"device", device},
        {"terms", model.terms},
        {"surface_side", model.surface_side},
        {"view_side", model.view_side},
        {"lambda_surface", model.lambda_surface},
        {"lambda_view", model.lambda_view},
        {"mu", bounds_weight(mu, choose_mode(mode))},
        {"clip_above", clip_above},
        {"shadow_below", shadow_below},
        {"lower", model.lower},
        {"upper", model.upper},
        {"deflate", deflate},
        {"iterations", iterations},
        {"validation", validation},
        {"stop_residual", stop_residual},
        {"stop_output_change", stop_output_change},
        {"seed", seed},
        {"record", record},
        {"memory", memory},
        {"records", records},
        {"refills", refills},
        {"ceres", ceres},
    };
    return object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);  // names may be no UTF-8
}

}  // namespace radiafit
