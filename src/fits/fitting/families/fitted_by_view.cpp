#include "fitting/families/fitted_by_view.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/statistics.h"
#include "fitting/plan/plan_rows.h"
#include "samples/projected_sides.h"
#include "viewbasis/learn_view_basis.h"

namespace radiafit::fits {
namespace {

/// Where triangles had 6 pixels, more texels showed 0.02 dB more at most.
constexpr double texels_per_pixel = 2;

/// The least of these sides with so many texels for a pixel of the median triangle where photographs show it largest.
int side_for_photographs(const Dataset& dataset) {
    constexpr int sides[] = {3, 4, 6, 8, 12};  // of side_ladder(), from where a search goes on
    const std::vector<uint32_t> training = dataset.split(false);
    std::vector<uint32_t> some;  // enough views to find the median
    const size_t step = std::max<size_t>(1, training.size() / 16);
    for (size_t i = 0; i < training.size(); i += step) some.push_back(training[i]);
    std::vector<double> areas = projected_areas(dataset, some);
    std::erase(areas, 0);
    const double wanted = areas.empty() ? HUGE_VAL : texels_per_pixel * median(std::move(areas));
    const auto* side = std::ranges::find_if(sides, [&](int n) { return double(TriangleTile::texels_of(n)) >= wanted; });
    return side == std::end(sides) ? sides[std::size(sides) - 1] : *side;
}

}  // namespace

FitOption noise_option() {
    return rows::number(
        "noise", 0, rows::own(&ByViewOptions::noise), limits::noise_variance,
        "variance of a residual, white being 1: how far samples count against what is known of the surface");
}

FitOption blocks_option() {
    return rows::number("blocks", 0, rows::own(&ByViewOptions::blocks), limits::blocks,
                        "about so many parts of the surface have a basis of their own; of lamps by default one for "
                        "6000 texels");
}

std::vector<FitOption> by_view_options(std::vector<FitOption> rows) {
    for (FitOption& row : rows) row.group = by_view_group;
    return rows;
}

void resolve_by_view(const Given& given, const Dataset& dataset, FitRequest& request) {
    if (!given("--surface-side")) request.model.surface_side = side_for_photographs(dataset);
    if (!given("--surface")) request.surface = SurfaceLookup::linear;
}

Ladder noise_ladder() { return {"noise", {"1.5e-4", "3e-4", "6e-4", "1.2e-3", "2.4e-3"}}; }
Ladder side_ladder() { return {"surface_side", {"3", "4", "6", "8", "12", "16"}}; }

std::unique_ptr<TriangleAtlas> by_view_atlas(const Dataset& dataset, const FitRequest& request) {
    auto atlas = std::make_unique<TriangleAtlas>(dataset.mesh, request.model.surface_side);
    if (request.part) atlas->set_normals(dataset.normal_map.normals);
    return atlas;
}

Plan plan_by_view(const Dataset& dataset, const FitRequest& request, size_t most_views, uint64_t n, PlanRow common) {
    request.check();
    require_light_field(dataset);
    const auto atlas = by_view_atlas(dataset, request);
    const uint64_t texels = atlas->texel_count();
    const uint64_t image = uint64_t(atlas->width()) * uint64_t(atlas->height()) * sizeof(float);
    Plan plan;
    plan.disk.push_back(
        {"maps",
         fmt::format("{} x {} pixels x {} floats, before they are compressed", atlas->width(), atlas->height(), n + 4),
         n + 4, image * (n + 4)});
    if (common.bytes > 0) plan.disk.push_back(common);
    std::vector<PlanRow>& rows = plan.memory;
    common.stages = PlanRow::while_learning | PlanRow::while_solving | PlanRow::while_writing;
    if (common.bytes > 0 && !request.part) rows.push_back(common);  // parts have it beside them
    add_samples(estimate_interpolated(dataset, *atlas, request, most_views), atlas->tile_count(),
                PlanRow::while_distributing | PlanRow::while_learning | PlanRow::while_solving, rows);
    add_mesh(dataset, rows);
    add_distributors(dataset, *atlas, fitted_views(dataset, request), rows);
    rows.push_back({"results", fmt::format("{} texels x ({} parameters, 4 figures)", texels, n), texels * n,
                    texels * 4 * (n + 4), PlanRow::while_solving | PlanRow::while_writing});
    if (request.part) {
        rows.push_back({"normals", fmt::format("of the whole, {} texels, twice", texels), texels,
                        2 * texels * sizeof(Vec3f), PlanRow::while_all});
        rows.push_back(
            {"results on their way to disk", "once more", texels * n, texels * 4 * (n + 4), PlanRow::while_writing});
    } else
        rows.push_back({"a map on its way to disk", fmt::format("an image and its file of {} bytes each", 3 * image), 1,
                        2 * 3 * image, PlanRow::while_writing});
    return plan;
}

void add_samples_of_some(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                         size_t most_views, uint64_t texels, std::vector<PlanRow>& rows) {
    const uint64_t all = std::max<uint64_t>(1, atlas.used_texels());
    const uint64_t samples =
        estimate_interpolated(dataset, atlas, request, most_views).samples * std::min(texels, all) / all;
    // A sample as its image gives it and as the list holds it, there at worst in a group by itself.
    constexpr uint64_t bytes = sizeof(Sample) + 2 * sizeof(uint32_t) + sizeof(Sample) + sizeof(SampleGroup);
    rows.push_back({"samples to learn from, about", fmt::format("of {} texels, x {} bytes", texels, bytes), samples,
                    samples * bytes + 4 * uint64_t(atlas.tile_count()), PlanRow::while_learning});
    add_distributors(dataset, atlas, fitted_views(dataset, request), rows);
    rows.back().stages = PlanRow::while_learning;
}

}  // namespace radiafit::fits
