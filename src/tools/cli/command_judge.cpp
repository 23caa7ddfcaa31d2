// judge: what a fit is worth.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string_view>

#include "base/choose.h"
#include "base/error.h"
#include "base/log.h"
#include "cli/commands.h"
#include "cli/rendered_pictures.h"
#include "cli/shown_fit.h"
#include "eval/outliers.h"
#include "fitting/family.h"
#include "fitting/limits.h"
#include "fitting/off_photographs.h"
#include "reachable/reachable.h"

namespace radiafit::tools {

namespace {

struct Judgement {
    JudgeResult fit, baseline;
    const char* baseline_name = nullptr;  ///< null: there is none
    std::vector<MaterialErrors> truth;
    std::vector<JudgedBeside> beside;
    int guesses = 0;       ///< images so far from those that were fitted
    std::string far = {};  ///< what is shown of the fit farthest from these, if any
};

/// Models that are made of all training photographs (reachable/reachable.h), by name. Throws UserError.
std::vector<const ReachableModel*> reachable_by_name(const std::vector<std::string>& asked) {
    std::vector<std::pair<std::string, const ReachableModel*>> all;
    for (const ReachableModel& model : reachable_models()) all.emplace_back(model.name, &model);
    std::vector<const ReachableModel*> out;
    for (const std::string& name : asked) out.push_back(choose("beside", name, all));
    return out;
}

/// The dataset as a fit is judged on this split of it.
Dataset judged_dataset(Fitted& fit, Split split) {
    const int validation = validation_of(fit.record());
    if (split == Split::validation && validation == 0)
        throw UserError("--split validation: the fit left no view out; fit with --validation N");
    return split == Split::test || validation == 0 ? fit.dataset() : for_validation(fit.dataset(), validation);
}

Judgement judge_fit(const std::string& folder, const std::string& moved_to, Split split, std::optional<int> points,
                    bool error_bars, const std::vector<const ReachableModel*>& others) {
    auto fit = open_fit(folder, moved_to);
    const Dataset judged = judged_dataset(fit, split);
    if (error_bars) {
        std::vector<View> shown;
        for (const uint32_t view : judged.split(split != Split::train)) shown.push_back(judged.views[view]);
        find_error_bars(fit, shown);
    }
    std::vector<MaterialErrors> errors = truth_errors(fit);
    const SurfaceParts parts = surface_parts(fit);
    auto baseline = baseline_of(fit);
    const JudgeOptions options{&parts, points.value_or(as_photographed), true};
    JudgeOptions with_angles = options;
    with_angles.by_angle = true;
    Judgement out = {judge(contestant_of(fit), judged, split, with_angles),
                     judge(contestant_of(baseline), judged, split, options),
                     baseline_name(fit),
                     std::move(errors),
                     {}};
    double least_share = 1;
    for (const ImageFigures& image : out.fit.images) {
        least_share = std::min(least_share, image.share_of_fit);
        out.guesses += is_guess(fit, image.share_of_fit);
    }
    if (out.guesses > 0) out.far = share_in_words(fit, least_share);
    for (const ReachableModel* other : others)
        out.beside.push_back(
            {other->name, other->words,
             judge(other->of(judged, judged.split(false), fit.record().space), judged, split, options)});
    return out;
}

/// Of the fit's own options, on views far from those that are fitted.
std::vector<OffPhotographs> judge_off(const std::string& folder, const std::string& moved_to,
                                      std::optional<int> pixel_points) {
    Fitted fit = open_fit(folder, moved_to);
    return judge_off_photographs(fit.dataset(), fit.record(), pixel_points.value_or(as_photographed),
                                 [](const OffPhotographs& off) {
                                     log_info(
                                         fmt::format("fitted without views within {:.0f} degrees of {} others: "
                                                     "{:.2f} dB there",
                                                     off.degrees, off.views, off.fit.psnr()));
                                 });
}

void print_off(const std::vector<OffPhotographs>& all, const char* baseline) {
    fmt::print("  degrees from all fitted views  views  fitted  PSNR, dB  {}, dB  worst view against that, dB\n",
               baseline);
    for (const OffPhotographs& off : all)
        fmt::print("  {:>29.0f}  {:5}  {:6}  {:8.2f}  {:{}.2f}  {:27.2f}\n", off.degrees, off.views, off.fitted,
                   off.fit.psnr(), off.baseline.psnr(), std::string_view(baseline).size() + 4, off.worst);
}

std::string json_with(const std::string& json, const std::vector<OffPhotographs>& all) {
    if (all.empty()) return json;
    nlohmann::ordered_json out = nlohmann::ordered_json::parse(json);
    for (const OffPhotographs& off : all)
        out["off_photographs"].push_back({{"degrees", off.degrees},
                                          {"views", off.views},
                                          {"fitted", off.fitted},
                                          {"psnr", off.fit.psnr()},
                                          {"baseline_psnr", off.baseline.psnr()},
                                          {"worst", off.worst}});
    return out.dump();
}

/// Of pictures that another program rendered of the dataset's views.
JudgeResult judge_pictures(const std::string& folder, const std::string& dataset_folder, Split split) {
    const Dataset dataset = open_dataset(dataset_folder);
    if (split == Split::validation)
        throw UserError("--split validation: which views are left out a fit knows; judge pictures on test or train");
    JudgeOptions options;
    options.pixel_points = 1;  // a picture has one value
    options.ssim = true;
    options.by_angle = true;
    const std::vector<uint32_t> views = dataset.split(split != Split::train);
    return judge(pictures_as_contestant(dataset, views, folder), dataset, split, options);
}

std::string text_of(const ErrorSums& errors) {
    if (errors.values == 0) return "no pixel";
    if (errors.not_finite == 0) return fmt::format("PSNR {:.2f} dB, APE {:.2f}", errors.psnr(), errors.ape());
    return fmt::format("no PSNR, since {} of {} rendered values are not finite", errors.not_finite, errors.values);
}

std::string text_of(const JudgeResult& result) {
    const std::string errors = text_of(result.stored);
    return result.ssim.windows ? fmt::format("{}, SSIM {:.3f}", errors, result.ssim.mean()) : errors;
}

/// Only angles that occur.
void print_by_angle(const JudgeResult& result) {
    if (!result.by_angle.any()) return;
    fmt::print("  degrees to the nearest training image  share of pixels  PSNR, dB\n");
    const auto row = [&](const std::string& name, const ErrorSums& sums) {
        if (sums.values > 0)
            fmt::print("{:>39}  {:13.1f} %  {:8.2f}\n", name, 100 * double(sums.values) / double(result.stored.values),
                       sums.psnr());
    };
    const auto& bounds = ErrorsByAngle::bounds;
    for (size_t i = 0; i < bounds.size(); ++i) row(fmt::format("up to {}", bounds[i]), result.by_angle.bins[i]);
    row(fmt::format("more than {}", bounds.back()), result.by_angle.bins.back());
    row("seen by none", result.by_angle.unseen);
}

void print_judgement(const Judgement& j) {
    fmt::print("{} views ({}): {}", j.fit.images.size(), to_string(j.fit.split), text_of(j.fit));
    fmt::print("{}\n", j.baseline_name ? fmt::format("; {}: {}", j.baseline_name, text_of(j.baseline)) : "");
    if (const size_t outside = j.fit.outside_count; outside > 0) {
        const auto tell = [&](size_t images, const char* where, const ErrorSums& fit, const ErrorSums& baseline) {
            fmt::print("  {} of them {} the directions of the training views: {}", images, where, text_of(fit));
            fmt::print("{}\n", j.baseline_name ? fmt::format("; {}: {}", j.baseline_name, text_of(baseline)) : "");
        };
        if (outside < j.fit.images.size()) tell(j.fit.images.size() - outside, "amid", j.fit.inside, j.baseline.inside);
        tell(outside, "beyond", j.fit.outside, j.baseline.outside);
    }
    for (size_t k = 0; k < j.fit.parts.size(); ++k)
        fmt::print("  {}: {}; {}: {}\n", j.fit.parts[k].name, text_of(j.fit.parts[k].stored), j.baseline_name,
                   text_of(j.baseline.parts[k].stored));
    for (const JudgedBeside& other : j.beside)
        fmt::print("  {}, which keeps every photograph: {}\n", other.words, text_of(other.result));
    if (const ErrorBarFigures& bars = j.fit.error_bars; bars.values > 0) {
        fmt::print("  error bars: {:.1f} % of the errors are within one standard deviation (true ones: 68 %)\n",
                   100 * bars.within_share());
        fmt::print("  don't trust {:.1f} % of the pixels, where the fit is less certain than a photograph: {}; {}\n",
                   100 * bars.doubtful_share(), text_of(bars.doubtful), "the others: " + text_of(bars.sound));
    }
    print_by_angle(j.fit);
    if (j.fit.missing_share() >= 0.001)
        fmt::print("  the mesh lacks {:.1f} % of the masks' pixels; with these, black in a render: {}\n",
                   100 * j.fit.missing_share(), text_of(j.fit.with_missing()));
    if (!j.far.empty()) fmt::print("  {} of them far from what was fitted; farthest out: {}\n", j.guesses, j.far);
    if (const auto outliers = outlying_images(j.fit); !outliers.empty())
        fmt::print(
            "  look at {}: the fit misses {} by far more than the others; fit --leave-out-outliers fits without\n",
            fmt::join(outliers, ", "), outliers.size() == 1 ? "it" : "them");
    for (const MaterialErrors& m : j.truth) {
        fmt::print("  {}: {} texels, RMSE of training samples {:.3g}", m.name, m.texels, m.rmse);
        if (m.comparable) {
            fmt::print("; parameters off by (worst of {}) {:.3g} % at the median, {:.3g} % at the 90th percentile",
                       m.parameters.size(), 100 * m.worst_median, 100 * m.worst_90);
            for (size_t i = 0; i < m.parameters.size(); ++i)
                fmt::print("{}{} {:.3g} %", i ? ", " : "; each: ", m.parameters[i], 100 * m.median[i]);
            if (const TruthShare all = m.within_all(); all.values > 0) {
                std::vector<std::string> each;
                for (size_t i = 0; i < m.within.size(); ++i)
                    if (m.within[i].values > 0)
                        each.push_back(fmt::format("{} {:.1f} %", m.parameters[i], 100 * m.within[i].share()));
                fmt::print("; {:.1f} % of {} parameters within one standard deviation of the truth; each: {}",
                           100 * all.share(), all.values, fmt::join(each, ", "));
            }
        }
        fmt::print("\n");
    }
}

/// Worst first.
void print_images(std::vector<ImageFigures> images) {
    std::ranges::stable_sort(images, {}, [](const ImageFigures& image) { return image.stored.psnr(); });
    fmt::print("PSNR, dB    APE    pixels  degrees outside the training views  image\n");
    for (const ImageFigures& image : images)
        fmt::print("{:8.2f} {:6.2f} {:9} {:35.1f}  {}\n", image.stored.psnr(), image.stored.ape(), image.pixels,
                   image.outside * 180 / std::numbers::pi, image.name);
}

Split choose_split(const std::string& name) {
    return choose<Split>("split", name,
                         {{"train", Split::train}, {"test", Split::test}, {"validation", Split::validation}});
}

}  // namespace

void add_pixel_points(CommandLine& command, std::optional<int>& points) {
    command.add_number("--pixel-points", points, limits::pixel_points,
                       "a pixel shows the mean over this many points, squared, of its area; 1: what its centre sees; "
                       "default: 3, but 1 where synthetic images were shaded at texels' centres");
}

void check_pixel_points(const std::optional<int>& points) {
    if (points) radiafit::check_pixel_points(*points);
}

void add_judge(CommandLine& program) {
    struct Options {
        std::string fit, renders, split = "test", dataset;
        std::optional<int> pixel_points;
        std::vector<std::string> beside;
        bool per_image = false, error_bars = false, off_photographs = false, json = false;
    };
    auto o = std::make_shared<Options>();
    CommandLine& command = program.add_command("judge", "APE and PSNR of a fit, beside those of the trivial baseline");
    command.add_text("fit", o->fit, "folder of the fit");
    command.add_text(
        "--renders", o->renders,
        "instead of a fit: a folder of another program's pictures of --dataset's views, named as its images "
        "(docs/judge.md)");
    command.add_word("--split", o->split, "train, test or validation").choices({"train", "test", "validation"});
    command.add_text("--dataset", o->dataset, "where the dataset is now, if it moved");
    add_pixel_points(command, o->pixel_points);
    command
        .add_words("--beside", o->beside,
                   "lumigraph or gaussian-process: what models reach that keep every training photograph")
        .choices({"lumigraph", "gaussian-process"});
    command.add_flag(
        "--covariance", o->error_bars,
        "how far noise moves the fit (of lfm, of a model under lamps), whether the errors agree, and where "
        "its colours can't be trusted");
    command.add_flag("--off-photographs", o->off_photographs,
                     "fits again, thrice, without the views within 15, 25 and 35 degrees of some, and judges these");
    command.add_flag("--per-image", o->per_image, "a table of the images as well, worst first");
    add_json(command, o->json);
    command.on_run([=] {
        const Split split = choose_split(o->split);
        check_pixel_points(o->pixel_points);
        const std::vector<const ReachableModel*> others = reachable_by_name(o->beside);
        if (!o->renders.empty()) {
            if (!o->fit.empty() || o->dataset.empty())
                throw UserError("--renders judges pictures of a dataset: give --dataset, and no fit");
            if (o->pixel_points || o->error_bars || o->off_photographs || !others.empty())
                throw UserError(
                    "--renders: pictures have one value a pixel and nothing more to say; leave out "
                    "--pixel-points, --covariance, --off-photographs and --beside");
            Judgement j;
            j.fit = judge_pictures(o->renders, o->dataset, split);
            if (o->json)
                fmt::print("{}\n", judge_json(j.fit));
            else
                print_judgement(j);
            if (o->per_image && !o->json) print_images(j.fit.images);
            return;
        }
        if (o->fit.empty()) throw UserError("fit is required, or --renders and --dataset");
        std::vector<OffPhotographs> off;
        if (o->off_photographs) off = judge_off(o->fit, o->dataset, o->pixel_points);
        const Judgement j = judge_fit(o->fit, o->dataset, split, o->pixel_points, o->error_bars, others);
        if (o->json)
            fmt::print("{}\n", json_with(judge_json(j.fit, &j.baseline, j.truth, j.beside), off));
        else
            print_judgement(j);
        if (!off.empty() && !o->json) print_off(off, j.baseline_name);
        if (o->per_image && !o->json) print_images(j.fit.images);
    });
}

}  // namespace radiafit::tools
