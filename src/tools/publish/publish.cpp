#include "publish/publish.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/error.h"
#include "base/forecast.h"
#include "base/json.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "base/wording.h"
#include "eval/render.h"
#include "publish/choices.h"
#include "publish/first_view.h"
#include "publish/pages.h"
#include "publish/scene_json.h"
#include "publish/steps.h"
#include "publish/uncertainty.h"

namespace radiafit::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr int page_format = 1;
constexpr double least_fidelity = 30, fidelity_step = 2, fidelity_slack = 3;  // dB
constexpr int most_attempts = 3;
constexpr float usual_step = 1.0f / 256;
constexpr double base64_growth = 4.0 / 3;

std::vector<SteppedMap> stepped_maps(const PageModel& model, const std::vector<std::array<float, 3>>& effects,
                                     double fidelity) {
    const auto steps = map_steps(model, effects, std::pow(10, -fidelity / 20));
    std::vector<SteppedMap> out(model.maps.size());
    parallel_for(out.size(), 1, [&](size_t m, int) { out[m] = stepped_map(model.maps[m], steps[m]); });
    return out;
}

/// Numbers whose steps follow from the fidelity.
double values_with_chosen_steps(const PageModel& model) {
    size_t values = 0;
    for (const PageMap& map : model.maps)
        if (map.fixed_step[0] == 0)
            values += map.image.values.size() - size_t(std::ranges::count(map.image.values, 0.0f));
    return std::max(1.0, double(values));
}

double megabytes(const std::vector<size_t>& bytes_of_maps, uint64_t other_bytes) {
    double sum = double(other_bytes);
    for (const size_t bytes : bytes_of_maps) sum += base64_growth * double(bytes);
    return sum / 1e6;
}

/// Lowers the fidelity of a page that is too large: by 6 dB for each bit that values have to lose, less a margin.
void lower(double& fidelity, double page_megabytes, const PageModel& model, const PublishOptions& options) {
    const double least = std::min(least_fidelity, options.fidelity);
    if (fidelity <= least)
        throw UserError(
            fmt::format("the page would have {:.1f} MB at {:.0f} dB; choose more {}, fewer {}, or fit with a "
                        "smaller surface side",
                        page_megabytes, fidelity, option_name("megabytes"), option_name("views")));
    const double decibels_per_bit = 20 * std::log10(2);
    const double bits = 8e6 * (page_megabytes - options.megabytes) / base64_growth / values_with_chosen_steps(model);
    fidelity = std::max(fidelity - std::max(fidelity_step, 0.8 * decibels_per_bit * bits), least);
}

/// Lowers the fidelity until the page is likely to be small enough.
std::vector<SteppedMap> maps_within(const PageModel& model, const std::vector<std::array<float, 3>>& effects,
                                    const PublishOptions& options, uint64_t other_bytes, double& fidelity) {
    for (;;) {
        std::vector<SteppedMap> maps = stepped_maps(model, effects, fidelity);
        std::vector<size_t> bytes(maps.size());
        parallel_for(maps.size(), 1, [&](size_t m, int) { bytes[m] = expected_bytes(maps[m]); });
        const double page_megabytes = megabytes(bytes, other_bytes);
        if (page_megabytes <= options.megabytes) return maps;
        lower(fidelity, page_megabytes, model, options);
    }
}

void add_uncertainty(Published& fit) {
    PageModel& model = fit.model;
    model.defines.emplace_back("UNCERTAINTY_MAP", std::to_string(model.maps.size()));
    model.maps.push_back(uncertainty_map(fit.fit, fit.dataset, fit.training, *model.atlas, model.most_uncertainty));
    fit.fit.error_bars = {};  // known for these views alone, but the judge would ask for others
}

void add_fit_normals(Published& fit) {
    PageModel& model = fit.model;
    model.defines.emplace_back("FIT_NORMALS", std::to_string(model.maps.size()));
    model.maps.push_back(fit_normal_map(fit.fit_normals, *model.atlas, fit.dataset.has_grid()));
}

Json scores_json(const PublishOutcome& o, double bytes_of_maps) {
    return {{"split", o.split == Split::test ? "held out" : "training"},
            {"photographs", o.photographs},
            {"psnr", o.psnr},
            {"shown_psnr", o.shown_psnr},
            {"baseline_psnr", o.baseline_psnr},
            {"fidelity", std::isfinite(o.fidelity) ? Json(o.fidelity) : Json()},
            {"map_bytes", bytes_of_maps}};
}

/// Errors in one photograph, or in all: of the fit, of the page's maps, of the baseline.
struct Scores {
    ErrorSums fit = {}, shown = {}, baseline = {};
    void add(const Scores& other) {
        fit.add(other.fit);
        shown.add(other.shown);
        baseline.add(other.baseline);
    }
};

/// Seconds that one thread takes.
double seconds_of(const std::function<void()>& run) {
    const Stopwatch clock;
    run();
    return clock.wall_s();
}

/// What publish() does, and how long it takes.
struct Work {
    /// Seconds, with all threads at work.
    struct Costs {
        double of_fit = 0, of_baseline = 0;  ///< a picture
        double stepping = 0, coding = 0;     ///< a map
        size_t maps = 0, steps = 0;          ///< chosen_steps()
    };
    /// chosen: how many views are pictures of the page; others: how many are judged besides.
    Work(const Costs& c, size_t chosen, size_t others) {
        pictures = forecast.add(chosen, c.of_fit + c.of_baseline);
        effects = forecast.add(c.steps, effect * c.stepping);
        trials = forecast.add(1, double(c.maps) * (trial * c.stepping + c.coding * share_of_bands));
        compared = forecast.add(chosen, c.of_fit);
        coding = forecast.add(c.maps, c.coding);
        judged = forecast.add(others, 2 * c.of_fit + c.of_baseline);
    }

    Forecast forecast;
    size_t pictures, effects, trials, compared, coding, judged;  ///< parts

private:
    static constexpr double effect = 2, trial = 3;  ///< in times of `stepping`, about
};

/// By a trial of each: a point of a view's pixels, bands of a map.
Work::Costs costs_of(const Published& fit, uint32_t view) {
    const Dataset& dataset = fit.dataset;
    const double threads = thread_count(), points = std::pow(PixelAreas(dataset).points(), 2);
    const auto picture = [&](const Contestant& contestant) {
        return points / threads * seconds_of([&] { render(contestant, dataset, dataset.views[view], 1); });
    };
    const PageMap& map = *std::ranges::max_element(
        fit.model.maps, {}, [](const PageMap& m) { return m.fixed_step[0] > 0 ? 0 : m.image.values.size(); });
    SteppedMap stepped;
    Work::Costs c;
    c.of_fit = picture(fit.fit);
    c.of_baseline = picture(fit.baseline);
    c.stepping = seconds_of([&] { stepped = stepped_map(map, {usual_step, usual_step, usual_step}); }) / threads;
    c.coding = seconds_of([&] { expected_bytes(stepped); }) / share_coded(stepped) / threads;
    c.maps = fit.model.maps.size();
    c.steps = chosen_steps(fit.model);
    return c;
}

/// A map of noise, which is as long to code as a map of a fit is.
PageMap noise_map(int side) {
    PageMap map{.name = "noise", .image = {side, side, {"R", "G", "B"}, {}, {}}};
    for (size_t i = 0; i < 3 * size_t(side) * size_t(side); ++i)
        map.image.values.push_back(0.2f * (2 * random_uniform(1, i) - 1));
    return map;
}

}  // namespace

double expected_seconds(size_t numbers, double view_seconds, size_t judged_views, const PublishOptions& options) {
    const PageMap noise = noise_map(256);
    const double share = double(numbers) / double(noise.image.values.size()) / thread_count();
    SteppedMap stepped;
    const double stepping = seconds_of([&] { stepped = stepped_map(noise, {usual_step, usual_step, usual_step}); });
    const double coding = seconds_of([&] { code_map(stepped); });
    const Work::Costs costs{view_seconds, view_seconds / 2, share * stepping, share * coding, 1, 1};
    const size_t chosen = size_t(options.views);
    return Work(costs, 2 * chosen, judged_views - std::min(chosen, judged_views)).forecast.seconds_left();
}

PublishOutcome publish(Published fit, const PublishOptions& options) {
    const Dataset& dataset = fit.dataset;
    PublishOutcome out;
    Page& page = out.page;
    const PageWords& words = options.words;
    page.title = words.title.empty() ? dataset.name : words.title;
    if (fit.fit.error_bars) add_uncertainty(fit);
    if (!fit.fit_normals.empty()) add_fit_normals(fit);
    const auto held_out = dataset.split(true);
    out.split = held_out.empty() ? Split::train : Split::test;
    std::vector<uint32_t> chosen = spread(held_out, size_t(options.views));
    for (const uint32_t view : spread(dataset.split(false), size_t(options.views))) chosen.push_back(view);
    const std::vector<uint32_t> all = dataset.split(out.split == Split::test);
    std::vector<uint32_t> others = all;
    std::erase_if(others, [&](uint32_t view) { return std::ranges::count(chosen, view) > 0; });
    const Work work(costs_of(fit, all[all.size() / 2]), chosen.size(), others.size());
    ForecastProgress progress("publish", work.forecast);

    Json json = {{"format", page_format},
                 {"title", page.title},
                 {"caption", words.caption},
                 {"credit", words.credit},
                 {"licence", words.licence},
                 {"unit_metres", words.unit_metres ? Json(*words.unit_metres) : Json()},
                 {"about", dataset.description},
                 {"source", dataset.source},
                 {"pixel_points", PixelAreas(dataset).points()},
                 {"shaders", Json::parse(shaders_json(fit))},
                 {"surface", Json::parse(surface_json(fit, page))},
                 {"model", Json::parse(model_json(fit, page))},
                 {"directions", Json::parse(directions_json(fit))}};
    progress.begin(work.pictures);
    ViewJudge judge(dataset);
    std::vector<Scores> scores(dataset.views.size());
    std::vector<JudgedView> judged(chosen.size());
    std::vector<Page> pictures(chosen.size());
    std::vector<std::string> views(chosen.size());
    parallel_for(chosen.size(), 1, [&](size_t i, int worker) {
        judged[i] = judge.compare(fit.fit, chosen[i], worker);
        const JudgedView baseline = judge.compare(fit.baseline, chosen[i], worker);
        scores[chosen[i]] = {.fit = errors_of(judged[i]), .baseline = errors_of(baseline)};
        views[i] = view_json(fit, chosen[i], judged[i], baseline, pictures[i]);
        progress.advance();
    });
    json["views"] = Json::array();
    for (size_t i = 0; i < chosen.size(); ++i) {
        json["views"].push_back(Json::parse(views[i]));
        std::ranges::move(pictures[i].blobs, std::back_inserter(page.blobs));
    }
    const size_t first = first_view(dataset, fit.training, chosen);
    json["first_view"] = first;
    page.picture = picture_of(judged[first], dataset.encoding);
    page.json = json_text(json);

    progress.begin(work.effects);
    const auto effects = map_effects(fit.model, dataset, fit.training, [&] { progress.advance(); });
    // Where a map's numbers cancel, the effect of noise on it alone tells too little: then finer ones are tried.
    std::vector<CodedMap> coded(fit.model.maps.size());
    Contestant shown;
    double asked = options.fidelity;
    for (int attempt = 0;; ++attempt) {
        progress.begin(work.trials);
        double kept = asked;
        const std::vector<SteppedMap> maps = maps_within(fit.model, effects, options, page.written_bytes(), kept);
        progress.advance();
        std::vector<PageMap> decoded(maps.size());
        parallel_for(maps.size(), 1, [&](size_t m, int) { decoded[m] = decoded_map(maps[m], fit.model.maps[m]); });
        shown = fit.model.shown(decoded).contestant;
        std::vector<ErrorSums> against_fit(chosen.size());
        progress.begin(work.compared);
        parallel_for(chosen.size(), 1, [&](size_t i, int worker) {
            const JudgedView view = judge.compare(shown, chosen[i], worker);
            scores[chosen[i]].shown = errors_of(view);
            against_fit[i] = differences(judged[i].render, view.render, view.foreground);
            progress.advance();
        });
        ErrorSums sum;
        for (const ErrorSums& d : against_fit) sum.add(d);
        out.fidelity = sum.psnr();
        const double missing = options.fidelity - out.fidelity;
        const bool finer = missing > fidelity_slack && kept >= asked && attempt < most_attempts;
        if (!finer) {
            progress.begin(work.coding);
            parallel_for(maps.size(), 1, [&](size_t m, int) {
                coded[m] = code_map(maps[m]);
                progress.advance();
            });
            std::vector<size_t> bytes;
            for (const CodedMap& map : coded) bytes.push_back(map.bytes());
            const double page_megabytes = megabytes(bytes, page.written_bytes());
            if (page_megabytes <= options.megabytes) break;
            lower(kept, page_megabytes, fit.model, options);  // bands told too little
            asked = kept;
            progress.add_steps(work.coding, maps.size());
        } else {
            asked += missing;
        }
        progress.add_steps(work.trials, 1);
        progress.add_steps(work.compared, chosen.size());
    }
    double bytes = 0;
    for (const CodedMap& map : coded) bytes += double(map.bytes());
    progress.begin(work.judged);
    parallel_for(others.size(), 1, [&](size_t i, int worker) {
        const uint32_t view = others[i];
        scores[view] = {errors_of(judge.compare(fit.fit, view, worker)), errors_of(judge.compare(shown, view, worker)),
                        errors_of(judge.compare(fit.baseline, view, worker))};
        progress.advance();
    });
    progress.finish();
    Scores pooled;
    for (const uint32_t view : all) pooled.add(scores[view]);
    check_foreground(pooled.fit, dataset, out.split);
    out.photographs = all.size();
    out.psnr = pooled.fit.psnr();
    out.shown_psnr = pooled.shown.psnr();
    out.baseline_psnr = pooled.baseline.psnr();

    json.update(Json::parse(maps_json(fit.model, coded, page)));
    json["scores"] = scores_json(out, bytes);
    page.json = json_text(json);
    return out;
}

}  // namespace radiafit::tools
