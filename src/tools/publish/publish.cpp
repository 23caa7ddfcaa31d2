#include "publish/publish.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/wording.h"
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
constexpr double base64_growth = 4.0 / 3;

std::vector<CodedMap> coded_maps(const PageModel& model, const std::vector<std::array<float, 3>>& steps) {
    std::vector<CodedMap> coded(model.maps.size());
    parallel_for(coded.size(), 1, [&](size_t m, int) { coded[m] = code_map(model.maps[m], steps[m]); });
    return coded;
}

/// Numbers whose steps follow from the fidelity.
double values_with_chosen_steps(const PageModel& model) {
    size_t values = 0;
    for (const PageMap& map : model.maps)
        if (map.fixed_step[0] == 0)
            values += map.image.values.size() - size_t(std::ranges::count(map.image.values, 0.0f));
    return std::max(1.0, double(values));
}

/// Lowers the fidelity until the page is small enough: by 6 dB for each bit that values have to lose, less a margin.
std::vector<CodedMap> maps_within(const PageModel& model, const std::vector<std::array<float, 3>>& effects,
                                  const PublishOptions& options, uint64_t other_bytes, double& fidelity) {
    const double decibels_per_bit = 20 * std::log10(2), values = values_with_chosen_steps(model);
    for (;;) {
        std::vector<CodedMap> coded = coded_maps(model, map_steps(model, effects, std::pow(10, -fidelity / 20)));
        uint64_t bytes = other_bytes;
        for (const CodedMap& map : coded) bytes += uint64_t(base64_growth * double(map.bytes()));
        if (double(bytes) <= 1e6 * options.megabytes) return coded;
        if (fidelity <= std::min(least_fidelity, options.fidelity))
            throw UserError(
                fmt::format("the page would have {:.1f} MB at {:.0f} dB; choose more {}, fewer {}, or fit with a "
                            "smaller surface side",
                            double(bytes) / 1e6, fidelity, option_name("megabytes"), option_name("views")));
        const double bits = 8 * (double(bytes) - 1e6 * options.megabytes) / base64_growth / values;
        fidelity -= std::max(fidelity_step, 0.8 * decibels_per_bit * bits);
        fidelity = std::max(fidelity, std::min(least_fidelity, options.fidelity));
    }
}

void add_differences(const JudgedView& a, const JudgedView& b, ErrorSums& sums) {
    for (size_t i = 0; i < a.foreground.size(); ++i)
        for (size_t c = 3 * i; c < 3 * i + 3 && a.foreground[i]; ++c)
            sums.add(double(a.render[c]) - double(b.render[c]));
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

}  // namespace

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
    std::vector<uint32_t> chosen = spread(held_out, size_t(options.views));
    for (const uint32_t view : spread(dataset.split(false), size_t(options.views))) chosen.push_back(view);
    std::vector<JudgedView> judged(chosen.size());
    Json views = Json::array();
    for (size_t i = 0; i < chosen.size(); ++i) {
        judged[i] = judged_view(fit.fit, dataset, chosen[i]);
        const JudgedView baseline = judged_view(fit.baseline, dataset, chosen[i]);
        views.push_back(Json::parse(view_json(fit, chosen[i], judged[i], baseline, page)));
    }
    json["views"] = views;
    const size_t first = first_view(dataset, fit.training, chosen);
    json["first_view"] = first;
    page.picture = picture_of(judged[first], dataset.encoding);
    page.json = json_text(json);

    // Where a map's numbers cancel, the effect of noise on it alone tells too little: then finer ones are tried.
    const auto effects = map_effects(fit.model, dataset, fit.training);
    std::vector<CodedMap> coded;
    Contestant shown;
    double asked = options.fidelity;
    for (int attempt = 0;; ++attempt) {
        double kept = asked;
        coded = maps_within(fit.model, effects, options, page.written_bytes(), kept);
        std::vector<PageMap> decoded;
        for (size_t m = 0; m < coded.size(); ++m) decoded.push_back(decoded_map(coded[m], fit.model.maps[m]));
        shown = fit.model.shown(decoded);
        ErrorSums differences;
        for (size_t i = 0; i < chosen.size(); ++i)
            add_differences(judged[i], judged_view(shown, dataset, chosen[i]), differences);
        out.fidelity = differences.psnr();
        const double missing = options.fidelity - out.fidelity;
        if (!(missing > fidelity_slack) || kept < asked || attempt == most_attempts) break;
        asked += missing;
    }
    double bytes = 0;
    for (const CodedMap& map : coded) bytes += double(map.bytes());
    const JudgeResult of_fit = judge(fit.fit, dataset, out.split);
    out.photographs = of_fit.images.size();
    out.psnr = of_fit.psnr();
    out.shown_psnr = judge(shown, dataset, out.split).psnr();
    out.baseline_psnr = judge(fit.baseline, dataset, out.split).psnr();

    json.update(Json::parse(maps_json(fit.model, coded, page)));
    json["scores"] = scores_json(out, bytes);
    page.json = json_text(json);
    return out;
}

}  // namespace radiafit::tools
