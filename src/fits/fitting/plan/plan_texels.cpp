#include <fmt/format.h>

#include "cpu/texel_solver.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"
#include "fitting/plan/plan_rows.h"
#include "fragment/texel_plan.h"

namespace radiafit::fits {
namespace {

/// Samples on disk by texel, and once more while they are sorted.
constexpr uint64_t texel_record_bytes = 2 * sizeof(TexelRadiance);

}  // namespace

Plan plan_texels(const Dataset& dataset, const FitRequest& request, size_t most_views) {
    require_lights(dataset);
    const TexelOptions options = request.texel_options();
    const FitFacts facts = facts_of(request);
    const auto atlas = texel_atlas(dataset, options.surface_side);
    const uint64_t texels = atlas->texel_count(), n = uint64_t(options.model->parameters);
    Plan plan;
    plan.disk.push_back(
        {"maps",
         fmt::format("{} x {} pixels x {} floats, before they are compressed", atlas->width(), atlas->height(), n + 4),
         n + 4, uint64_t(atlas->width()) * uint64_t(atlas->height()) * 4 * (n + 4)});
    std::vector<PlanRow>& rows = plan.memory;
    if (request.on_fragment_engine()) {
        rows = rows_of(plan_texel_engine(dataset, *atlas, fitted_views(dataset, request), options,
                                         request.fragment_options(), room_of(request.optimizer_options())));
        add_host_images(dataset, request, rows);
        return plan;
    }
    const uint64_t samples = estimate_samples(dataset, *atlas, request, most_views).samples;
    rows.push_back({"results", fmt::format("{} texels x ({} parameters, 4 figures)", texels, n), texels * n,
                    texels * 4 * (n + 4) - 3 * texels});
    if (request.has_prior() && !request.part) rows.push_back(prior_row(*options.model, texels));
    if (request.has_prior() && request.part)
        for (auto* list : {&rows, &plan.disk})
            list->push_back({"samples of poorly seen texels, at most",
                             fmt::format("pixels in texels x {} bytes", sizeof(TexelRadiance)), samples,
                             samples * sizeof(TexelRadiance)});
    if (facts.records) {
        rows.push_back(held_samples(request, samples * texel_record_bytes));
        plan.disk.push_back({"records, about", fmt::format("samples x {} bytes", texel_record_bytes), samples,
                             samples * texel_record_bytes});
        return plan;
    }
    rows.push_back({"samples, about", fmt::format("pixels in texels x {} bytes", sizeof(TexelRadiance)), samples,
                    samples * sizeof(TexelRadiance)});
    if (request.on_engine(EngineKind::compute)) {
        const uint64_t maps = n / 3 + 1, vectors = uint64_t(room_of(request.optimizer_options()).vector_count());
        rows.push_back({"vectors, about", fmt::format("{} x {} texels x {} x 4 floats", vectors, texels, maps),
                        vectors * texels * n, vectors * texels * maps * 16});
        rows.push_back({"samples that count, about", "once more, and for the device", 2 * samples, 48 * samples});
        rows.push_back({"texels", "their surface, samples and numbers", texels, 160 * texels});
    } else if (facts.on_engine && !request.levenberg_marquardt())
        rows.push_back(
            {"engine, about", "shaded samples in batches of eight texels; p, trial, d, g, trial g, P, fresh P", samples,
             texel_solvers(*options.model).stream_bytes(texels, samples, room_of(request.optimizer_options()))});
    return plan;
}

}  // namespace radiafit::fits
