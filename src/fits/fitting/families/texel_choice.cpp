#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fitting/families/lamp_contest.h"
#include "fitting/family.h"
#include "fitting/resolve_options.h"
#include "lightbasis/texel_lights.h"

namespace radiafit::fits {
namespace {

// Measured on captures with some of their images left out (datasets/captures.md).
constexpr double least_images_of_lafortune = 4;
constexpr double least_images_of_contest = 8;  // so that some can be left out to judge by
constexpr const char *clip_above = "0.98", *shadow_below = "0.1";

/// Of what sRGB pictures store.
FitSetting on_curve(const char* model) { return {{"model", model}, {"curve", "srgb"}}; }

}  // namespace

std::optional<Chosen> choose_texel_model(const Given& given, const Dataset& dataset, const FitRequest& request) {
    if (!dataset.light_moves()) return {};
    const double images = views_per_texel(dataset);
    const std::string seen = fmt::format("lamps that move, a median of {:.3g} training images per texel", images);
    const auto selected = [](const char* model) {
        return FitSetting{{"model", model}, {"clip_above", clip_above}, {"shadow_below", shadow_below}};
    };
    std::vector<FitSetting> settings;
    for (const FitSetting& setting : {selected("lafortune"), on_curve("lafortune"), selected("ptm"), on_curve("ptm"),
                                      FitSetting{{"model", light_basis_name}}}) {
        FitRequest of_model = request;
        of_model.model_name = setting.front().second;
        if (!takes_given(given, of_model)) continue;
        const bool curved = setting.back().first == "curve";
        if (curved && (given("--curve") || of_model.on_fragment_engine())) continue;
        if (of_model.texel_model() || lamps_have_all_colours(dataset)) settings.push_back(setting);
    }
    std::vector<ContestResult> results;
    if (images >= least_images_of_contest && settings.size() > 1)
        results = lamp_contest(dataset, settings, given, request);
    if (results.empty()) {
        const bool few = images < least_images_of_lafortune;
        const FitSetting first = settings.empty() ? selected("lafortune") : settings.front();
        return Chosen{few && find_texel_model(first.front().second) ? selected("lambert") : first,
                      [seen] { return seen; }};
    }
    return Chosen{results.front().setting, [results] {
                      std::vector<std::string> told;
                      for (const ContestResult& r : results)
                          told.push_back(fmt::format("{} {:.1f} dB", command_line_of(r.setting), r.psnr));
                      return fmt::format("lamps that move; fits of some texels predict images that they left out: {}",
                                         fmt::join(told, ", "));
                  }};
}

std::vector<TuneCandidate> texel_candidates(const Dataset& dataset) {
    if (!dataset.light_moves()) return {};
    std::vector<Ladder> ladders = {{"clip_above", {"0", "0.9", "0.98"}}, {"shadow_below", {"0", "0.05", "0.1", "0.2"}}};
    for (Ladder& ladder : loss_ladders()) ladders.push_back(std::move(ladder));
    std::vector<TuneCandidate> out;
    for (const char* model : {"lafortune", "ptm", "lambert"}) {
        const FitSetting plain = {{"model", model}};
        FitSetting selected = plain, robust;
        selected.insert(selected.end(), {{"clip_above", clip_above}, {"shadow_below", shadow_below}});
        robust = selected;
        robust.emplace_back("loss", "huber");
        out.push_back({{plain, selected, robust}, ladders});
    }
    ladders.push_back({"curve", {"srgb", "root", "linear"}});
    for (const char* model : {"lafortune", "ptm", "hsh2", "hsh3", "hsh4", "hsh5"})
        out.push_back({{on_curve(model)}, ladders});
    return out;
}

}  // namespace radiafit::fits
