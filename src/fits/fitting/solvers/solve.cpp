#include "fitting/solvers/solve.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <stdexcept>

#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "fitting/fit_options.h"
#include "fitting/solvers/solver.h"
#include "fragment/gl_distributor.h"
#include "samples/grid_distributor.h"
#include "samples/interpolated_samples.h"
#include "samples/projected_sides.h"
#include "samples/raster_distributor.h"

namespace radiafit::fits {

void require_seen(bool seen, const Dataset& dataset, const FitRequest& request) {
    if (seen || request.part) return;
    throw UserError(dataset.folder.string() +
                    ": no training view sees the mesh; check that mesh and calibration share one frame");
}

std::vector<Distributor*> Distributors::workers() const { return worker_pointers(owned); }

Distributors make_distributors(const Atlas& any, const FitRequest& request) {
    Distributors out;
    if (const auto* grid = dynamic_cast<const GridAtlas*>(&any)) {
        for (int i = 0; i < thread_count(); ++i) out.owned.push_back(std::make_unique<GridDistributor>(*grid));
        return out;
    }
    const auto& atlas = dynamic_cast<const TriangleAtlas&>(any);
    if (request.distributor == DistributorKind::gl) {
        out.context = Context::create(request.context);
        out.owned.push_back(std::make_unique<GlDistributor>(atlas));
    } else {
        out.owned = raster_distributors(atlas);
    }
    return out;
}

SampleList list_samples(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                        const std::vector<uint32_t>& views, DistributionStatistics* statistics) {
    if (request.surface == SurfaceLookup::linear) return interpolated_samples(dataset, atlas, views, request.space);
    const Distributors distributors = make_distributors(atlas, request);
    return build_sample_list(dataset, atlas, views, distributors.workers(), request.space, statistics);
}

SharedSamples distribute(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                         const std::vector<uint32_t>& views) {
    Stopwatch clock;
    SharedSamples out;
    out.list = list_samples(dataset, atlas, request, views, &out.statistics);
    out.seconds = clock.wall_s();
    require_seen(!out.list.samples.empty(), dataset, request);
    return out;
}

SharedSamples distribute(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request) {
    return distribute(dataset, atlas, request, dataset.split(false));
}

namespace {
bool validates(size_t training_view, int every) { return every > 0 && int(training_view) % every == every / 2; }

/// Names with commas between them.
std::vector<std::string> listed(const std::string& names) {
    std::vector<std::string> out;
    for (size_t from = 0; from < names.size();) {
        const size_t comma = std::min(names.find(',', from), names.size());
        if (comma > from) out.push_back(names.substr(from, comma - from));
        from = comma + 1;
    }
    return out;
}

/// Without those that the request leaves out.
std::vector<uint32_t> without_left_out(const Dataset& dataset, const FitRequest& request, std::vector<uint32_t> views) {
    for (const std::string& name : listed(request.leave_out)) {
        const auto named = [&](uint32_t view) { return dataset.views[view].name == name; };
        if (std::ranges::none_of(dataset.split(false), named))
            throw UserError(
                fmt::format("leave-out: {} has no training image '{}'; radiafit judge --per-image tells names",
                            dataset.folder.string(), name));
        std::erase_if(views, named);
    }
    return views;
}
}  // namespace

std::vector<uint32_t> fitted_views(const Dataset& dataset, const FitRequest& request) {
    const std::vector<uint32_t> training = dataset.split(false);
    if (request.validation > int(training.size()))
        throw UserError(fmt::format("validation = {}: {} has {} training views; choose fewer", request.validation,
                                    dataset.folder.string(), training.size()));
    std::vector<uint32_t> out;
    for (size_t k = 0; k < training.size(); ++k)
        if (!validates(k, request.validation)) out.push_back(training[k]);
    out = without_left_out(dataset, request, std::move(out));
    if (out.empty() && !training.empty())
        throw UserError(
            fmt::format("leave-out: no training image of {} is left to fit; name fewer", dataset.folder.string()));
    return out;
}

std::vector<uint32_t> judged_views(const Dataset& dataset, const FitRequest& request) {
    if (request.validation == 0) return dataset.split(true);
    const std::vector<uint32_t> training = dataset.split(false);
    std::vector<uint32_t> out;
    for (size_t k = 0; k < training.size(); ++k)
        if (validates(k, request.validation)) out.push_back(training[k]);
    return out;
}

Dataset for_validation(Dataset dataset, int validation) {
    std::vector<View> views;
    for (const uint32_t view : dataset.split(false)) {
        views.push_back(dataset.views[view]);
        views.back().held_out = validates(views.size() - 1, validation);
    }
    dataset.views = std::move(views);
    return dataset;
}

void describe_request(const FitRequest& request, FitRecord& fit) {
    fit.space = request.space;
    fit.surface = request.surface;
    fit.solver = request.solver;
    fit.engine = (facts_of(request).on_engine ? request : FitRequest()).text("engine");
    fit.options_json = request.json();
}

FitRequest with_sides(FitRequest request, const Dataset& dataset, const std::vector<uint32_t>& views) {
    if (request.texels_per_pixel == 0 || request.model.sides) return request;
    request.model.sides = sides_by_area(projected_areas(dataset, views), request.texels_per_pixel);
    request.model.surface_side = largest_of(request.model.sides);
    return request;
}

namespace {

/// What the solvers of one dataset and one kind of maps share.
struct Setting {
    const Stopwatch clock;
    FitRequest request;
    TriangleAtlas atlas;
    VertexRings rings;

    Setting(const Dataset& dataset, const FitRequest& asked, const std::vector<uint32_t>& views)
        : request(with_sides(asked, dataset, views)),
          atlas(surface_atlas(dataset.mesh, request.model)),
          rings(dataset.mesh),
          sides_s_(request.model.sides == asked.model.sides ? 0 : clock.wall_s()) {}

    /// Once the task is solved.
    void complete(const FitTask& task, const FitRequest& asked) const {
        FitOutcome& out = task.out;
        out.fit.options = task.options;
        describe_request(asked, out.fit);
        set_dataset(out.fit, task.dataset);
        out.times.distribution += sides_s_;
        out.times.total = clock.wall_s() - out.times.outside;
    }

private:
    double sides_s_;
};

}  // namespace

FitOutcome solve(const Dataset& dataset, const FitRequest& asked, const SharedSamples* samples,
                 const IterationHook& each_iteration, const std::vector<uint32_t>* views) {
    asked.check();
    require_light_field(dataset);
    const std::vector<uint32_t> training = views ? *views : fitted_views(dataset, asked);
    const Setting setting(dataset, asked, training);
    FitOutcome out;
    FitTask task(dataset, setting.request, setting.atlas, setting.rings, training, each_iteration, samples, out);
    find_solver(asked.solver).solve(task);
    setting.complete(task, asked);
    return out;
}

std::vector<FitOutcome> solve_by_refills(const Dataset& dataset, const FitRequest& asked,
                                         std::span<const int> refills) {
    if (!facts_of(asked).resamples || refills.empty() || !std::ranges::is_sorted(refills))
        throw std::invalid_argument("solve_by_refills: a solver that resamples, some refills, fewest first");
    asked.check();
    require_light_field(dataset);
    const std::vector<uint32_t> training = fitted_views(dataset, asked);
    const Setting setting(dataset, asked, training);
    const SharedSamples samples = distribute(dataset, setting.atlas, setting.request, training);
    std::vector<FitRequest> requests(refills.size(), setting.request);
    std::vector<FitOutcome> outcomes(refills.size());
    const IterationHook no_hook;
    std::vector<std::unique_ptr<FitTask>> owned;
    std::vector<FitTask*> tasks;
    for (size_t i = 0; i < refills.size(); ++i) {
        requests[i].refills = refills[i];
        owned.push_back(std::make_unique<FitTask>(dataset, requests[i], setting.atlas, setting.rings, training, no_hook,
                                                  &samples, outcomes[i]));
        tasks.push_back(owned.back().get());
    }
    solve_pca(tasks);
    for (size_t i = 0; i < tasks.size(); ++i) {
        FitRequest own = asked;
        own.refills = refills[i];
        setting.complete(*tasks[i], own);
    }
    return outcomes;
}

}  // namespace radiafit::fits
