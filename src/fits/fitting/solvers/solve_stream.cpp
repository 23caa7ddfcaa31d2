#include "base/clock.h"
#include "base/file.h"
#include "base/log.h"
#include "base/parallel.h"
#include "compute/compute_engine.h"
#include "cpu/lfm_engine.h"
#include "cpu/vertex_solver.h"
#include "dataset/dataset_json.h"
#include "fitting/solvers/solver.h"
#include "fragment/fragment_engine.h"
#include "model/lfm_start.h"

namespace radiafit::fits {
namespace {

/// Starts, optimizes and reads back one engine.
template <Engine E>
void run_engine(E& engine, const LfmLayout& layout, FitTask& task) {
    const FitRequest& request = task.request;
    const ProblemStatistics statistics = engine.count();
    require_seen(statistics.any(), task.dataset, request);
    Progress progress("iterations", size_t(request.iterations) + 1);
    const auto hook = [&](int iteration) {
        progress.advance();
        if (task.each_iteration)
            task.each_iteration(iteration, [&](std::span<float> errors) { engine.read_errors(errors); });
    };
    std::vector<float> parameters = lfm_start(layout, statistics.mean, request.seed);
    task.out.trace =
        optimize_terms(engine, request.optimizer_options(), task.options.terms, request.deflate, parameters, hook);
    progress.finish();
    std::vector<ProblemOutcome> outcomes(engine.problem_count());
    engine.outcomes(outcomes);
    fill_outcomes(task, layout, statistics, outcomes, std::move(parameters));
}

void with_fragment_engine(FitTask& task) {
    static_assert(Engine<FragmentEngine>);
    const FitRequest& request = task.request;
    FitOutcome& out = task.out;
    const auto context = open_context(request, out);
    Stopwatch clock;
    FragmentEngine engine(task.dataset, task.atlas, task.rings, task.views, task.options, request.fragment_options());
    run_engine(engine, engine.layout(), task);
    take_sweeps(engine.times(), clock.wall_s(), task.dataset, out);
    out.engine_bytes = engine.bytes();
}

void with_cpu_engine(FitTask& task) {
    FitOutcome& out = task.out;
    const SampleList& samples = task.samples();
    Stopwatch clock;
    if (task.each_iteration) {  // wants all problems after each iteration
        LfmProblem<float> problem(task.dataset, task.atlas, task.rings, samples, task.options);
        StreamEngine<float> engine(problem);
        run_engine(engine, problem.layout(), task);
        out.engine_bytes = engine.bytes();
    } else {
        Progress progress("vertices", task.rings.vertex_count());
        VertexSolution solution = solve_vertices(task.dataset, task.atlas, task.rings, samples, task.options,
                                                 task.request.vertex_solver_options(), [&] { progress.advance(); });
        progress.finish();
        take_solution(task, std::move(solution));
        out.engine_bytes = uint64_t(thread_count()) * out.working_set_bytes;
    }
    out.times.optimization = clock.wall_s();
}

void with_compute_engine(FitTask& task) {
    static_assert(Engine<ComputeEngine>);
    const FitRequest& request = task.request;
    FitOutcome& out = task.out;
    const SampleList* samples = request.redistributes() ? nullptr : &task.samples();
    const auto context = open_context(request, out);
    Stopwatch clock;
    const auto engine =
        samples ? std::make_unique<ComputeEngine>(task.dataset, task.atlas, task.rings, *samples, task.options,
                                                  request.accumulate)
                : std::make_unique<ComputeEngine>(task.dataset, task.atlas, task.rings, task.views, task.options,
                                                  request.stream_options(), request.accumulate);
    out.accumulation = describe(engine->accumulate());
    run_engine(*engine, engine->layout(), task);
    out.engine_bytes = engine->bytes();
    out.group_size = engine->group_size();
    if (samples)
        out.times.optimization = clock.wall_s();
    else
        take_sweeps(engine->times(), clock.wall_s(), task.dataset, out);
}

}  // namespace

std::unique_ptr<Context> open_context(const FitRequest& request, FitRun& run) {
    auto context = Context::create(request.context);
    run.gl_vendor = context->vendor();
    run.gl_renderer = context->renderer();
    run.gl_version = context->version();
    return context;
}

void take_sweeps(const SweepTimes& times, double seconds, const Dataset& dataset, FitRun& run) {
    run.times.streaming = times.stream_s + times.upload_s;
    run.times.optimization = seconds - run.times.streaming;
    run.images_cached_share = cached_share(dataset.folder / dataset_images_name);
    run.sweep_cpu_ms_per_image = times.images ? 1e3 * times.sweep_cpu_s / double(times.images) : 0;
}

void solve_stream(FitTask& task) {
    switch (task.request.engine) {
        case EngineKind::cpu:
            return with_cpu_engine(task);
        case EngineKind::fragment:
            return with_fragment_engine(task);
        case EngineKind::compute:
            return with_compute_engine(task);
    }
}

}  // namespace radiafit::fits
