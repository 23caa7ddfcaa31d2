// render: how a fit looks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/choose.h"
#include "base/error.h"
#include "cli/commands.h"
#include "cli/frames.h"
#include "cli/pictures.h"
#include "cli/raking.h"
#include "cli/render_options.h"
#include "cli/shown_fit.h"
#include "cli/turntable.h"
#include "fitting/family.h"
#include "report/problem_picture.h"

namespace radiafit::tools {
namespace {

namespace fs = std::filesystem;

/// A distant lamp in this direction, of any length.
Light lamp_towards(const std::vector<double>& xyz) {
    const Vec3d direction(xyz[0], xyz[1], xyz[2]);
    const double length = direction.norm();
    if (!(std::isfinite(length) && length > 0))
        throw UserError(fmt::format("--light {}: a direction's length is finite and not 0; choose, say, 0,0.6,0.8",
                                    fmt::join(xyz, ",")));
    return {Light::Kind::distant, direction / length, Vec3d::Ones()};
}

/// Whether a photograph shows the same as the picture.
bool is_compared(const RenderOptions& o) { return o.light.empty() && !o.enhancement; }

/// Views of a fit beside their photographs.
class Views {
public:
    Views(const RenderOptions& options, Fitted& fitted, Pictures& pictures)
        : options_(&options), fitted_(&fitted), pictures_(&pictures), fit_(shown_fit(options, fitted)) {
        if (!is_compared(options)) return;
        baseline_ = baseline_of(fitted);
        judge_.emplace(fitted.dataset(), options.points());
    }

    /// Adds the fit as a photograph shows it, and the sheet that compares the two; any thread.
    void add_photographed(const std::string& name, uint32_t view, int worker = 0) {
        const Dataset& dataset = fitted_->dataset();
        const JudgedView judged = judge_->compare(fit_, view, worker);
        const JudgedView trivial = judge_->compare(contestant_of(*baseline_), view, worker);
        pictures_->add(name, in_exposure(picture(dataset.views[view], worker), judged.gain));
        pictures_->add_sheet(
            name, comparison_sheet(judged, &trivial, dataset.encoding),
            fmt::format("photograph {}, {}, fit, 4 x |error|", dataset.views[view].name, baseline_name(*fitted_)));
    }
    /// Under another lamp, or enhanced, so that there is nothing to compare with.
    void add_relit(const std::string& name, const View& shown) { pictures_->add(name, picture(shown)); }

    double share_of_fit(const View& shown) const { return fit_.share_of_fit ? fit_.share_of_fit(shown) : 1; }

private:
    LightImage picture(const View& shown, int worker = 0) const {
        const Dataset& dataset = fitted_->dataset();
        return render(fit_, dataset, options_->framed(shown, dataset), options_->points(), worker);
    }

    const RenderOptions* options_;
    Fitted* fitted_;
    Pictures* pictures_;
    Contestant fit_;
    std::optional<Fitted> baseline_;  ///< where pictures are compared
    std::optional<ViewJudge> judge_;  ///< there, too
};

/// Of the files of one picture.
std::vector<const char*> endings_of(const RenderOptions& o) {
    if (o.problems) return {".png", ".svg"};
    if (is_compared(o)) return {".png", ".exr", "_sheet.png"};
    return {".png", ".exr"};
}

/// A folder of many pictures may hold other things; they are asked for one by one (Pictures::check).
std::vector<OutputTarget> targets_of(const RenderOptions& o) {
    check_render_output(o);
    std::vector<OutputTarget> targets;
    if (o.makes_many() && !o.output.empty()) targets.push_back({.path = o.output, .shared = true});
    if (!o.makes_many()) {
        const fs::path stem = picture_stem(o.output);
        OutputTarget picture{.path = stem};
        for (const char* ending : endings_of(o)) picture.files.push_back(fs::path(stem).concat(ending));
        picture.check = [files = picture.files] { std::ranges::for_each(files, check_ours); };
        targets.push_back(std::move(picture));
    }
    if (!o.video.empty()) targets.push_back({.path = o.video, .check = [file = o.video] { check_ours(file); }});
    return targets;
}

void render_view(const RenderOptions& o, Fitted& fitted, uint32_t view, const View& shown) {
    const fs::path stem = picture_stem(o.output);
    const std::string name = stem.filename().string();
    Pictures pictures(stem.parent_path(), o.background);
    for (const char* ending : endings_of(o)) pictures.check(name, {ending});
    Views views(o, fitted, pictures);
    describe_share(fitted, views.share_of_fit(shown));
    if (is_compared(o))
        views.add_photographed(name, view);
    else
        views.add_relit(name, shown);
    pictures.commit();
}

/// Every view of a split, into a folder.
void render_all(const RenderOptions& o, Fitted& fitted) {
    const Dataset& dataset = fitted.dataset();
    const bool held_out = choose<bool>("all", o.all, {{"held-out", true}, {"train", false}});
    const std::vector<uint32_t> shown = dataset.split(held_out);
    if (shown.empty()) throw UserError(fmt::format("--all {}: {} has no such view", o.all, dataset.name));
    const auto name_of = [](uint32_t view) { return fmt::format("view{:04d}", view); };
    Pictures pictures(o.output, o.background);
    for (const uint32_t view : shown) pictures.check(name_of(view), {".png", ".exr", "_sheet.png"});
    Views views(o, fitted, pictures);
    make_pictures("render", shown.size(),
                  [&](size_t i, int worker) { views.add_photographed(name_of(shown[i]), shown[i], worker); });
    pictures.commit();
}

/// Where a fit's problems ended and how, each at its texel; none where they have no place on a picture.
std::optional<ProblemPicture> problem_picture_of(const Fitted& fitted) {
    const auto* m = std::get_if<FittedReflectance>(&fitted.model);
    if (!m) return {};
    const ReflectanceFit& fit = m->fit;
    const Atlas& atlas = *m->atlas;
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
    picture.mark = picture_remark();
    return picture;
}

void render_problems(const RenderOptions& o, Fitted& fit) {
    const auto picture = problem_picture_of(fit);
    if (!picture)
        throw UserError("--problems: those of a light field map are vertices, with no place of their own on a picture");
    const fs::path stem = picture_stem(o.output);
    Pictures pictures(stem.parent_path());
    for (const char* ending : endings_of(o)) pictures.check(stem.filename().string(), {ending});
    pictures.add(stem.filename().string(), *picture);
    pictures.commit();
}

void render_fit(const RenderOptions& o) {
    check_pixel_points(o.pixel_points);
    auto fit = open_fit(o.fit, o.dataset);
    if (!o.light.empty()) require_lamps(fit, "--light");
    if (o.raking) require_lamps(fit, "--raking");
    if (o.enhancement) require_lamps(fit, "--enhance");
    if (o.problems) return render_problems(o, fit);
    const Dataset& dataset = fit.dataset();
    if (o.size && dataset.has_grid())
        throw UserError("--size: over a grid, a picture has a pixel per texel; leave it out");
    if (!o.all.empty()) return render_all(o, fit);
    const uint32_t view = chosen_view(dataset, o.view);
    View shown = dataset.views[view];
    if (!o.light.empty()) shown.light = lamp_towards(o.light);
    if (o.turntable > 0) return render_turntable(o, fit, shown);
    if (o.raking) return render_raking(o, fit, shown);
    render_view(o, fit, view, shown);
}

}  // namespace

void add_render(CommandLine& program) {
    auto o = std::make_shared<RenderOptions>();
    CommandLine& command = program.add_command("render", "a view of a fit as EXR and PNG, beside the photograph");
    add_render_options(command, *o);
    command.writes([=] { return targets_of(*o); });
    command.on_run([=] { render_fit(*o); });
}

}  // namespace radiafit::tools
