#include <fmt/format.h>

#include <algorithm>

#include "fitting/family.h"
#include "fitting/resolve_options.h"

namespace radiafit::fits {
namespace {

// Measured on captures with some of their images left out (datasets/captures.md).
constexpr double least_images_of_ptm = 16, least_images_of_lafortune = 4;
constexpr const char *clip_above = "0.98", *shadow_below = "0.1";

/// No more is known of the surface than its plane.
bool flat(const Grid& grid) {
    const Vec3f plane = grid.normal().cast<float>();
    return std::ranges::all_of(grid.texel_normals,
                               [&](const Vec3f& n) { return n.isZero() || n.dot(plane) > 1 - 1e-6f; });
}

bool one_direction(const Dataset& dataset) {
    const auto& first = dataset.views.front().camera_direction;
    return first && std::ranges::all_of(dataset.views, [&](const View& view) {
               return view.camera_direction && view.camera_direction->dot(*first) > 1 - 1e-9;
           });
}

}  // namespace

std::optional<Chosen> choose_texel_model(const Given&, const Dataset& dataset) {
    if (!dataset.light_moves()) return {};
    const double images = views_per_texel(dataset);
    const std::string seen = fmt::format("a median of {:.3g} training images per texel", images);
    FitSetting setting = {{"model", ""}, {"clip_above", clip_above}, {"shadow_below", shadow_below}};
    const auto chosen = [&](const char* model, const std::string& why) {
        setting.front().second = model;
        return Chosen{setting, [why] { return "lamps that move, " + why; }};
    };
    if (dataset.has_grid() && flat(dataset.grid) && one_direction(dataset) && images >= least_images_of_ptm)
        return chosen("ptm", fmt::format("no normals but the plane's, {}", seen));
    return chosen(images >= least_images_of_lafortune ? "lafortune" : "lambert", seen);
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
    return out;
}

}  // namespace radiafit::fits
