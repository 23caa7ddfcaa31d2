#include "app/solve.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "app/choices.h"
#include "app/run_engine.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "cpu/stream_engine.h"
#include "gl/gl_distributor.h"
#include "reference/mean_solver.h"
#include "samples/raster_distributor.h"

namespace radiafit {

void reject_unseen(const Dataset& dataset) {
    throw UserError(dataset.folder.string() +
                    ": no training view sees the mesh; check that mesh and calibration share one frame");
}

SharedSamples distribute(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                         const std::vector<uint32_t>& views) {
    Stopwatch clock;
    SharedSamples out;
    std::unique_ptr<Context> context;
    std::vector<std::unique_ptr<Distributor>> distributors;
    if (choose_distributor(request.distributor) == DistributorChoice::gl) {
        context = Context::create(context_options(request));
        distributors.push_back(std::make_unique<GlDistributor>(atlas));
    } else {
        for (int i = 0; i < thread_count(); ++i) distributors.push_back(std::make_unique<RasterDistributor>(atlas));
    }
    std::vector<Distributor*> workers;
    for (const auto& d : distributors) workers.push_back(d.get());
    out.list = build_sample_list(dataset, atlas, views, workers, choose_space(request.space), &out.statistics);
    out.seconds = clock.wall_s();
    if (out.list.samples.empty()) reject_unseen(dataset);
    return out;
}

SharedSamples distribute(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request) {
    return distribute(dataset, atlas, request, dataset.split(false));
}

namespace {

/// What every solver leaves to say about its problems.
void fill_fit(const Dataset& dataset, const FitRequest& request, const LfmOptions& options, LightFieldFit& fit) {
    fit.options = options;
    fit.space = choose_space(request.space);
    fit.solver = request.solver;
    fit.engine = request.engine;
    fit.options_json = request.json();
    set_dataset(fit, dataset);
}

void fill_mean(const SampleList& samples, const VertexRings& rings, LightFieldFit& fit) {
    const size_t problems = 3 * rings.vertex_count();
    fit.status.assign(problems, Status::no_samples);
    fit.iterations.assign(problems, 0);
    fit.samples.assign(problems, 0);
    fit.error.assign(problems, 0.0f);
    for (size_t i = 0; i < problems; ++i) {
        for (const Corner& c : rings.ring(i / 3))
            fit.samples[i] += samples.groups[samples.tile_groups[c.triangle + 1]].first -
                              samples.groups[samples.tile_groups[c.triangle]].first;
        if (fit.samples[i]) fit.status[i] = Status::stationary;
    }
}

}  // namespace

FitOutcome solve(const Dataset& dataset, const FitRequest& request, const SharedSamples* samples,
                 const IterationHook& each_iteration, const std::vector<uint32_t>* views) {
    request.check();
    const LfmOptions options = request.model_options();
    const TriangleAtlas atlas(dataset.mesh, options.surface_side);
    const VertexRings rings(dataset.mesh);
    const std::vector<uint32_t> training = views ? *views : dataset.split(false);
    Stopwatch clock;
    FitOutcome out;

    if (request.solver == "stream" && request.engine == "fragment") {
        solve_with_fragment_engine(dataset, atlas, rings, training, request, each_iteration, out);
    } else {
        SharedSamples own;
        if (!samples) {
            own = distribute(dataset, atlas, request, training);
            samples = &own;
            out.times.distribution = own.seconds;
        }
        out.distribution = samples->statistics;
        if (request.solver == "mean") {
            LfmOptions one = options;
            one.terms = 1;
            one.view_side = 2;
            fill_fit(dataset, request, one, out.fit);
            const LfmLayout layout(rings, int(atlas.texels_per_tile()), one.view_side, 1);
            out.fit.parameters = mean_solver(atlas, rings, layout, samples->list);
            fill_mean(samples->list, rings, out.fit);
            out.times.total = clock.wall_s();
            return out;
        }
        Stopwatch optimization;
        LfmProblem<float> problem(dataset, atlas, rings, samples->list, options);
        StreamEngine<float> engine(problem);
        run_engine(engine, dataset, problem.layout(), request, options, each_iteration, out);
        out.engine_bytes = engine.bytes();
        out.times.optimization = optimization.wall_s();
    }
    fill_fit(dataset, request, options, out.fit);
    out.times.total = clock.wall_s();
    return out;
}

}  // namespace radiafit
