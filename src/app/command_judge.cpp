// judge: what a fit is worth.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "base/error.h"
#include "base/log.h"
#include "dataset/truth.h"
#include "eval/judge.h"
#include "eval/reflectance_renderer.h"
#include "eval/truth_errors.h"

namespace radiafit {

namespace {
/// FitRequest::validation of the fit.
int validation_of(const FitRecord& fit) {
    const auto options = nlohmann::json::parse(fit.options_json.empty() ? "{}" : fit.options_json, nullptr, false);
    if (!options.is_object() || !options.contains("validation")) return 0;
    const auto& validation = options.at("validation");
    if (!validation.is_number_unsigned() || validation != validation.get<int>() || validation.get<int>() < 0)
        throw UserError(fmt::format("the fit of {}: fit.json's options.validation is no number of views; fit again",
                                    fit.dataset_name));
    return validation.get<int>();
}
}  // namespace

ReflectanceOutcome baseline_of(const ReflectanceFit& fit, const Dataset& dataset) {
    FitRequest diffuse;
    diffuse.kind = "lambert";
    diffuse.set("optimizer", "lm");
    diffuse.model.surface_side = fit.options.surface_side;
    diffuse.clip_above = fit.options.clip_above;
    diffuse.shadow_below = fit.options.shadow_below;
    diffuse.validation = validation_of(fit);
    return solve_reflectance(dataset, diffuse);
}

LightFieldFit baseline_of(const LightFieldFit& fit, const Dataset& dataset) {
    FitRequest mean;
    mean.solver = "mean";
    mean.space = fit.space;
    mean.model = fit.options;
    mean.validation = validation_of(fit);
    return solve(dataset, mean).fit;
}

namespace {

struct Judgement {
    JudgeResult fit, baseline;
    const char* baseline_name;
    std::vector<MaterialErrors> truth = {};  ///< of a synthetic dataset
};

/// The dataset as a fit is judged on this split of it.
Dataset judged_dataset(const FitRecord& fit, const Dataset& dataset, Split split) {
    const int validation = validation_of(fit);
    if (split == Split::validation && validation == 0)
        throw UserError("--split validation: the fit left no view out; fit with --validation N");
    return split == Split::test || validation == 0 ? dataset : for_validation(dataset, validation);
}

Judgement judge_light_field(const std::string& folder, const std::string& moved_to, Split split) {
    const LightFieldFit fit = read_fit(folder).fit;
    const Dataset dataset = open_fitted_dataset(fit, moved_to), judged = judged_dataset(fit, dataset, split);
    return {judge(fit, judged, split), judge(baseline_of(fit, dataset), judged, split), light_field_baseline};
}

Judgement judge_reflectance(const std::string& folder, const std::string& moved_to, Split split) {
    const StoredReflectance stored = read_reflectance(folder, moved_to);
    const Dataset &dataset = *stored.dataset, judged = judged_dataset(stored.fit, dataset, split);
    const Atlas& atlas = *stored.atlas;
    ReflectanceTruth truth;
    std::vector<MaterialErrors> errors;
    SurfaceParts parts;
    const ReflectanceRenderer renderer(atlas, stored.fit);
    const bool known = has_truth(dataset);
    if (known) {
        truth = read_truth(dataset.folder);
        errors = truth_errors(stored.fit, truth);
        for (const TruthMaterial& material : truth.materials) parts.names.push_back(material.name);
        parts.of = [&](const RasterPixel& pixel) { return size_t(truth.material[renderer.texel_of(pixel)]); };
    }
    const SurfaceParts* materials = known ? &parts : nullptr;
    const ReflectanceOutcome baseline = baseline_of(stored.fit, dataset);
    return {judge(stored.fit, atlas, judged, split, materials), judge(baseline.fit, atlas, judged, split, materials),
            reflectance_baseline, std::move(errors)};
}

std::string text_of(const ErrorSums& errors) {
    if (errors.values == 0) return "no pixel";
    if (errors.not_finite == 0) return fmt::format("PSNR {:.2f} dB, APE {:.2f}", errors.psnr(), errors.ape());
    return fmt::format("no PSNR, since {} of {} rendered values are not finite", errors.not_finite, errors.values);
}

void print_judgement(const Judgement& j) {
    fmt::print("{} views ({}): {}; {}: {}\n", j.fit.images.size(), to_string(j.fit.split), text_of(j.fit.stored),
               j.baseline_name, text_of(j.baseline.stored));
    for (size_t k = 0; k < j.fit.parts.size(); ++k)
        fmt::print("  {}: {}; {}: {}\n", j.fit.parts[k].name, text_of(j.fit.parts[k].stored), j.baseline_name,
                   text_of(j.baseline.parts[k].stored));
    for (const MaterialErrors& m : j.truth) {
        fmt::print("  {}: {} texels, RMSE of training samples {:.3g}", m.name, m.texels, m.rmse);
        if (m.comparable) {
            fmt::print("; parameters off by (worst of {}) {:.3g} % at the median, {:.3g} % at the 90th percentile",
                       m.parameters.size(), 100 * m.worst_median, 100 * m.worst_90);
            for (size_t i = 0; i < m.parameters.size(); ++i)
                fmt::print("{}{} {:.3g} %", i ? ", " : "; each: ", m.parameters[i], 100 * m.median[i]);
        }
        fmt::print("\n");
    }
}

Split choose_split(const std::string& name) {
    return choose<Split>("split", name,
                         {{"train", Split::train}, {"test", Split::test}, {"validation", Split::validation}});
}

}  // namespace

void add_judge(CommandLine& program) {
    struct Options {
        std::string fit, split = "test", dataset;
        bool json = false;
    };
    auto o = std::make_shared<Options>();
    CommandLine& command = program.add_command("judge", "APE and PSNR of a fit, beside those of the trivial baseline");
    command.add_text("fit", o->fit, "folder of the fit").required();
    command.add_word("--split", o->split, "train, test or validation");
    command.add_text("--dataset", o->dataset, "where the dataset is now, if it moved");
    command.add_flag("--json", o->json, "one JSON object on standard output");
    command.on_run([=] {
        const Split split = choose_split(o->split);
        if (o->json) set_quiet(true);
        const Judgement j = fitted_model(o->fit) == "lfm" ? judge_light_field(o->fit, o->dataset, split)
                                                          : judge_reflectance(o->fit, o->dataset, split);
        if (o->json)
            fmt::print("{}\n", judge_json(j.fit, &j.baseline, j.truth));
        else
            print_judgement(j);
    });
}

}  // namespace radiafit
