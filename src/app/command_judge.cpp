// judge, render: what a fit is worth, and how it looks.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/commands.h"
#include "base/error.h"
#include "base/log.h"
#include "capture/image_file.h"
#include "dataset/truth.h"
#include "eval/judge.h"
#include "eval/reflectance_renderer.h"
#include "eval/render.h"
#include "eval/truth_errors.h"
#include "report/problem_picture.h"

namespace radiafit {

namespace {
/// FitRequest::validation of the fit.
int validation_of(const FitRecord& fit) {
    const auto options = nlohmann::json::parse(fit.options_json.empty() ? "{}" : fit.options_json, nullptr, false);
    if (!options.is_object() || !options.contains("validation")) return 0;
    const auto& validation = options.at("validation");
    if (!validation.is_number_integer() || validation.get<int>() < 0)
        throw UserError(fmt::format("the fit of {}: fit.json's options.validation is no number of views; fit again",
                                    fit.dataset_name));
    return validation.get<int>();
}
}  // namespace

ReflectanceOutcome baseline_of(const ReflectanceFit& fit, const Dataset& dataset) {
    FitRequest diffuse;
    diffuse.kind = "lambert";
    diffuse.optimizer = "lm";
    diffuse.model.surface_side = fit.options.surface_side;
    diffuse.clip_above = fit.options.clip_above;
    diffuse.shadow_below = fit.options.shadow_below;
    diffuse.validation = validation_of(fit);
    return solve_reflectance(dataset, diffuse);
}

LightFieldFit baseline_of(const LightFieldFit& fit, const Dataset& dataset) {
    FitRequest mean;
    mean.solver = "mean";
    mean.space = fit.space == TargetSpace::linear ? "linear" : "stored";
    mean.model = fit.options;
    mean.validation = validation_of(fit);
    return solve(dataset, mean).fit;
}

namespace {

constexpr const char* light_field_baseline = "mean colour per texel";
constexpr const char* reflectance_baseline = "Lambertian";

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
    const bool known = has_truth(dataset.folder);
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

void print_judgement(const Judgement& j) {
    fmt::print("{} views ({}): PSNR {:.2f} dB, APE {:.2f}; {}: PSNR {:.2f} dB, APE {:.2f}\n", j.fit.images.size(),
               to_string(j.fit.split), j.fit.psnr(), j.fit.ape(), j.baseline_name, j.baseline.psnr(), j.baseline.ape());
    for (size_t k = 0; k < j.fit.parts.size(); ++k)
        fmt::print("  {}: PSNR {:.2f} dB; {}: {:.2f} dB\n", j.fit.parts[k].name, j.fit.parts[k].stored.psnr(),
                   j.baseline_name, j.baseline.parts[k].stored.psnr());
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
    if (name == "train") return Split::train;
    if (name == "test") return Split::test;
    if (name == "validation") return Split::validation;
    throw UserError("split '" + name + "' does not exist; choose train, test or validation");
}

struct RenderOptions {
    std::string fit, output, dataset;
    std::optional<int> view;
    int turntable = 0;
    std::vector<double> light;  ///< direction, or empty
    bool problems = false;
};

/// A camera on a circle around the mesh, as far away and as high as the capture's cameras are on average.
Camera turntable_camera(const Dataset& dataset, int i, int count) {
    Vec3d center = Vec3d::Zero(), up = Vec3d::Zero();
    for (const Vec3f& p : dataset.mesh.positions) center += p.cast<double>() / double(dataset.mesh.vertex_count());
    double distance = 0, height = 0;
    for (const View& v : dataset.views) up -= v.camera.cam_from_world_rotation.row(1).transpose();
    up.normalize();
    for (const View& v : dataset.views) {
        const Vec3d d = v.camera.center() - center;
        distance += d.norm() / double(dataset.views.size());
        height += up.dot(d.normalized()) / double(dataset.views.size());
    }
    const Vec3d any = std::abs(up.z()) < 0.9 ? Vec3d::UnitZ() : Vec3d::UnitX();
    const Vec3d east = any.cross(up).normalized(), north = up.cross(east);
    const double angle = 2 * 3.14159265358979 * i / count, flat = std::sqrt(std::max(0.0, 1 - height * height));
    const Vec3d eye = center + distance * (height * up + flat * (std::cos(angle) * east + std::sin(angle) * north));
    const Camera& like = dataset.views[0].camera;
    Camera camera =
        Camera::look_at(eye, center, up, 2 * std::atan(0.5 * like.height / like.fy), like.width, like.height);
    return camera;
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
        throw UserError(fmt::format("cannot write {}: {}; choose a writable folder", folder.string(), error.message()));
}

void write_light(const std::filesystem::path& stem, const LightImage& image) {
    write_light_exr(stem.string() + ".exr", image);
    const ByteImage bytes = to_bytes(image);
    write_png(stem.string() + ".png", bytes.width, bytes.height, bytes.rgb);
    log_info(fmt::format("{0}.png, {0}.exr", stem.string()));
}

/// The view that was asked for, or one from the middle of those held out.
uint32_t chosen_view(const Dataset& dataset, std::optional<int> view) {
    if (view) {
        if (*view < 0 || size_t(*view) >= dataset.views.size())
            throw UserError(
                fmt::format("--view {}: {} has views 0 to {}", *view, dataset.name, dataset.views.size() - 1));
        return uint32_t(*view);
    }
    const auto held_out = dataset.split(true);
    return held_out.empty() ? 0 : held_out[held_out.size() / 2];
}

/// A distant lamp in this direction, of any length.
Light lamp_towards(const std::vector<double>& xyz) {
    const Vec3d direction(xyz[0], xyz[1], xyz[2]);
    const double length = direction.norm();
    if (!(std::isfinite(length) && length > 0))
        throw UserError(fmt::format("--light {}: a direction's length is finite and not 0; choose, say, 0,0.6,0.8",
                                    fmt::join(xyz, ",")));
    return {Light::Kind::distant, direction / length, Vec3d::Ones()};
}

/// FILE.png and FILE.exr alike name FILE; its folder is made.
std::filesystem::path stem_of(const std::string& output) {
    const std::filesystem::path out(output);
    const std::filesystem::path stem =
        out.extension() == ".png" || out.extension() == ".exr" ? std::filesystem::path(out).replace_extension() : out;
    if (!stem.parent_path().empty()) make_folder(stem.parent_path());
    return stem;
}

void write_sheet(const std::filesystem::path& stem, const JudgedView& fit, const JudgedView& baseline,
                 const Dataset& dataset, uint32_t view, const char* baseline_name) {
    const ByteImage sheet = comparison_sheet(fit, &baseline, dataset.encoding);
    write_png(stem.string() + "_sheet.png", sheet.width, sheet.height, sheet.rgb);
    log_info(fmt::format("{}_sheet.png: photograph {}, {}, fit, 4 x |error|", stem.string(), dataset.views[view].name,
                         baseline_name));
}

void render_light_field(const RenderOptions& o) {
    if (o.problems)
        throw UserError("--problems: those of a light field map are vertices, with no place of their own on a picture");
    if (!o.light.empty()) throw UserError("--light: a light field map keeps the light it was photographed under");
    const StoredFit stored = read_fit(o.fit);
    const LightFieldFit& fit = stored.fit;
    const Dataset dataset = open_fitted_dataset(fit, o.dataset);
    if (o.turntable > 0) {
        const std::filesystem::path out(o.output);
        make_folder(out);
        for (int i = 0; i < o.turntable; ++i)
            write_light(out / fmt::format("turn{:03d}", i),
                        render_fit(fit, dataset.mesh, turntable_camera(dataset, i, o.turntable)));
        return;
    }
    const uint32_t view = chosen_view(dataset, o.view);
    const std::filesystem::path stem = stem_of(o.output);
    write_light(stem, render_fit(fit, dataset.mesh, dataset.views[view].camera));
    write_sheet(stem, judged_view(fit, dataset, view), judged_view(baseline_of(fit, dataset), dataset, view), dataset,
                view, light_field_baseline);
}

/// Where and why a fit failed, as a picture.
void render_problems(const StoredReflectance& stored, const std::filesystem::path& stem) {
    const ReflectanceFit& fit = stored.fit;
    const Atlas& atlas = *stored.atlas;
    ProblemPicture picture;
    picture.width = atlas.width();
    picture.height = atlas.height();
    for (auto* map : {&picture.status, &picture.iterations, &picture.samples, &picture.rms})
        map->assign(size_t(picture.width) * size_t(picture.height), NAN);
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
        if (!atlas.usable(t)) continue;
        const auto [x, y] = atlas.place(t);
        const size_t at = size_t(y) * size_t(picture.width) + size_t(x);
        picture.status[at] = float(fit.status[t]);
        picture.iterations[at] = float(fit.iterations[t]);
        picture.samples[at] = float(fit.samples[t]);
        if (fit.samples[t] > 0) picture.rms[at] = std::sqrt(2 * fit.error[t] / (3 * float(fit.samples[t])));
    }
    for (size_t s = 0; s < size_t(Status::count); ++s) picture.status_names.push_back(to_string(Status(s)));
    picture.title = fmt::format("{}: {} by {} on {}, a problem per texel", fit.dataset_name, fit.options.model->name,
                                fit.solver, fit.engine);
    picture.unit = "reflectance (white = 1)";
    draw_problems(picture, stem);
    log_info(fmt::format("{0}.png, {0}.svg", stem.string()));
}

void render_reflectance(const RenderOptions& o) {
    const StoredReflectance stored = read_reflectance(o.fit, o.dataset);
    if (o.problems) return render_problems(stored, stem_of(o.output));
    const Dataset& dataset = *stored.dataset;
    const uint32_t view = chosen_view(dataset, o.view);
    View shown = dataset.views[view];
    if (!o.light.empty()) shown.light = lamp_towards(o.light);
    if (o.turntable > 0) {
        if (dataset.has_grid()) throw UserError("--turntable: a grid is seen from where its camera stood");
        const std::filesystem::path out(o.output);
        make_folder(out);
        for (int i = 0; i < o.turntable; ++i) {
            shown.camera = turntable_camera(dataset, i, o.turntable);
            write_light(out / fmt::format("turn{:03d}", i), render_fit(stored.fit, *stored.atlas, dataset, shown));
        }
        return;
    }
    const std::filesystem::path stem = stem_of(o.output);
    write_light(stem, render_fit(stored.fit, *stored.atlas, dataset, shown));
    if (!o.light.empty()) return;  // there is no photograph to compare with
    const ReflectanceOutcome baseline = baseline_of(stored.fit, dataset);
    write_sheet(stem, judged_view(stored.fit, *stored.atlas, dataset, view),
                judged_view(baseline.fit, *stored.atlas, dataset, view), dataset, view, reflectance_baseline);
}

void render(const RenderOptions& o) { (fitted_model(o.fit) == "lfm" ? render_light_field : render_reflectance)(o); }

}  // namespace

void add_judge(CLI::App& app) {
    struct Options {
        std::string fit, split = "test", dataset;
        bool json = false;
    };
    auto o = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("judge", "APE and PSNR of a fit, beside those of the trivial baseline");
    command->add_option("fit", o->fit, "folder of the fit")->required();
    command->add_option("--split", o->split, "train, test or validation")->capture_default_str();
    command->add_option("--dataset", o->dataset, "where the dataset is now, if it moved");
    command->add_flag("--json", o->json, "one JSON object on standard output");
    command->callback([=] {
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

void add_render(CLI::App& app) {
    auto o = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "a view of a fit as EXR and PNG, beside the photograph");
    command->add_option("fit", o->fit, "folder of the fit")->required();
    auto* view = command->add_option("--view", o->view, "view index; default: a held-out one");
    command->add_option("--turntable", o->turntable, "this many views around the object instead")
        ->excludes(view)
        ->check(CLI::Range(1, 10000));
    command->add_option("--light", o->light, "x y z: direction to a distant lamp of intensity 1, of a reflectance fit")
        ->expected(3)
        ->delimiter(',');
    command
        ->add_flag("--problems", o->problems,
                   "how each texel's fit ended, its iterations, samples and error, in the atlas, of a reflectance fit")
        ->excludes(view)
        ->excludes("--light")
        ->excludes("--turntable");
    command->add_option("--dataset", o->dataset, "where the dataset is now, if it moved");
    command->add_option("-o,--output", o->output, "file name without or with extension; a folder for --turntable")
        ->required();
    command->callback([=] { render(*o); });
}

}  // namespace radiafit
