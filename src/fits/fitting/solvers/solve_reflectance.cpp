#include <fmt/format.h>

#include <algorithm>

#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "compute/texel_compute_engine.h"
#include "cpu/surface_prior.h"
#include "cpu/texel_solver.h"
#include "fitting/fit_options.h"
#include "fitting/solvers/solver.h"
#include "fragment/texel_engine.h"
#include "optim/optimizer.h"
#include "reference/ceres_texel.h"
#include "samples/picked_texels.h"

namespace radiafit::fits {
namespace {

namespace fs = std::filesystem;

void take(TexelResult result, TexelTask& task) {
    ReflectanceOutcome& out = task.out;
    out.fit.parameters = std::move(result.parameters);
    out.fit.status = std::move(result.status);
    out.fit.iterations = std::move(result.iterations);
    out.fit.samples = std::move(result.samples);
    out.fit.error = std::move(result.error);
    out.trace = std::move(result.trace);
    out.engine_bytes = result.engine_bytes;
    out.sample_iterations = result.sample_iterations;
}

SharedTexels gather(const Dataset& dataset, const Atlas& atlas, const FitRequest& request,
                    const std::vector<uint32_t>& views) {
    Stopwatch clock;
    SharedTexels out;
    const Distributors distributors = make_distributors(atlas, request);
    out.source = gather_texels(dataset, atlas, views, distributors.workers());
    out.seconds = clock.wall_s();
    return out;
}

/// Calls solve(source) with the shared samples, or with some gathered for it.
template <class Solve>
void with_samples(TexelTask& task, const Solve& solve) {
    SharedTexels own;
    if (!task.shared) own = gather(task.dataset, *task.out.atlas, task.request, task.views);
    task.out.times.distribution = own.seconds;
    const TexelSource& source = task.shared ? *task.shared->source : *own.source;
    task.out.samples = source.sample_count();
    solve(source);
}

/// What solves texels one after another, with its progress shown.
template <class Solve>
void solve_source(const TexelSource& source, TexelTask& task, const Solve& solve) {
    require_seen(source.sample_count() > 0, task.dataset, task.request);
    Stopwatch clock;
    const TexelLoader all(task.dataset, *task.out.atlas, task.views, task.options);
    const TexelLoader loader = task.shared && !task.shared->texels.empty() ? all.of(task.shared->texels) : all;
    Progress progress("texels", source.block_count());
    TexelResult result =
        solve(TexelProblem{source, loader, task.options, task.request.journal.get()}, [&] { progress.advance(); });
    progress.finish();
    task.out.times.streaming += result.load_s;
    task.out.times.optimization = clock.wall_s() - result.load_s;
    take(std::move(result), task);
}

TexelResult by_levenberg_marquardt(const TexelProblem& problem, TexelTask& task,
                                   const std::function<void()>& progress) {
    if (task.request.has_prior() && !task.request.part)
        return solve_lm_with_surface(problem, *task.out.atlas, task.fit_options(), progress);
    TexelResult out = task.solvers().solve_lm(problem, task.fit_options(), progress);
    if (task.request.has_prior())
        task.out.poorly_seen = samples_of(problem.source, poorly_seen(*task.options.model, out));
    return out;
}

/// What the engine ended with, in the canonical gauge, with E itself.
template <Engine E>
void take_fit(E& engine, const ProblemStatistics& statistics, TexelTask& task) {
    ReflectanceOutcome& out = task.out;
    const TexelModel& model = *task.options.model;
    ReflectanceFit& fit = out.fit;
    const size_t texels = engine.problem_count(), n = size_t(model.parameters);
    std::vector<ProblemOutcome> outcomes(texels);
    engine.outcomes(outcomes);
    fit.parameters.resize(texels * n);
    engine.read_parameters(fit.parameters);
    fit.samples = statistics.samples;
    out.samples = 0;
    for (size_t t = 0; t < texels; ++t) {
        const std::span<float> p(&fit.parameters[t * n], n);
        fit.status.push_back(outcomes[t].status);
        fit.iterations.push_back(outcomes[t].iterations);
        // the engine's error is E / S-bar plus the penalty
        const double data = std::max(0.0, double(outcomes[t].error) - bounds_penalty(task.options, p));
        fit.error.push_back(float(data * statistics.samples[t]));
        out.samples += statistics.samples[t];
        out.sample_iterations += uint64_t(statistics.samples[t]) * outcomes[t].iterations;
        model.make_canonical(p);
    }
    out.engine_bytes = engine.bytes();
}

template <Engine E>
void optimize_engine(E& engine, TexelTask& task) {
    task.out.trace = optimize(engine, task.request.optimizer_options(), [&](int iteration) {
        if (task.each_iteration)
            task.each_iteration(iteration, [&](std::span<float> errors) { engine.read_errors(errors); });
    });
}

void solve_fragment(TexelTask& task) {
    const auto context = open_context(task.request, task.out);
    Stopwatch clock;
    TexelFragmentEngine engine(task.dataset, *task.out.atlas, task.views, task.options,
                               task.request.fragment_options());
    const ProblemStatistics statistics = engine.count();
    engine.reset(engine.start());
    optimize_engine(engine, task);
    take_fit(engine, statistics, task);
    take_sweeps(engine.times(), clock.wall_s(), task.dataset, task.out);
}

/// body(worker, first texel, how many, their samples): eight texels at a time, or what is left of a block, on all
/// cores. Returns the seconds that reading and shading took, per core.
template <class Body>
double for_eights(const TexelProblem& problem, const std::function<void()>& block_done, const Body& body) {
    constexpr size_t eight = 8;
    std::vector<double> load_s(size_t(thread_count()), 0);
    parallel_for(problem.source.block_count(), 1, [&](size_t block, int worker) {
        Stopwatch clock;
        TexelSamples samples;
        std::vector<std::vector<ShadedSample>> shaded(eight);
        const uint32_t begin = uint32_t(block) * TexelSource::block;
        problem.source.read(begin, samples);
        load_s[size_t(worker)] += clock.wall_s();
        const size_t count = samples.first.size() - 1;
        for (size_t first = 0; first < count; first += eight) {
            clock.restart();
            for (size_t i = 0; i < eight; ++i) {
                shaded[i].clear();
                if (first + i < count)
                    problem.loader.load(begin + uint32_t(first + i), samples.of(first + i), shaded[i]);
            }
            load_s[size_t(worker)] += clock.wall_s();
            body(worker, begin + first, std::min(eight, count - first), shaded);
        }
        if (block_done) block_done();
    });
    double sum = 0;
    for (const double s : load_s) sum += s / thread_count();
    return sum;
}

void solve_compute(TexelTask& task) {
    with_samples(task, [&](const TexelSource& source) {
        require_seen(source.sample_count() > 0, task.dataset, task.request);
        const auto context = open_context(task.request, task.out);
        Stopwatch clock;
        const TexelLoader loader(task.dataset, *task.out.atlas, task.views, task.options);
        TexelComputeEngine engine(task.dataset, *task.out.atlas, task.views, task.options, source);
        const ProblemStatistics statistics = engine.count();
        engine.reset(starts_of({source, loader, task.options}));
        optimize_engine(engine, task);
        take_fit(engine, statistics, task);
        task.out.group_size = engine.group_size();
        task.out.times.optimization = clock.wall_s();
    });
}

}  // namespace

std::vector<float> starts_of(const TexelProblem& problem) {
    const TexelSolvers& solvers = texel_solvers(*problem.options.model);
    const size_t n = size_t(problem.options.model->parameters);
    std::vector<float> out(problem.source.texel_count() * n);
    for_eights(problem, {}, [&](int, size_t first, size_t count, const auto& shaded) {
        std::copy_n(solvers.start(shaded).begin(), count * n, &out[first * n]);
    });
    return out;
}

void solve_texel_stream(TexelTask& task) {
    if (task.request.on_engine(EngineKind::fragment)) return solve_fragment(task);
    if (task.request.on_engine(EngineKind::compute)) return solve_compute(task);
    with_samples(task, [&](const TexelSource& source) {
        solve_source(source, task, [&](const TexelProblem& problem, const auto& progress) {
            return task.request.levenberg_marquardt()
                       ? by_levenberg_marquardt(problem, task, progress)
                       : task.solvers().stream(problem, task.request.optimizer_options(), task.each_iteration);
        });
    });
}

void solve_texel_two_step(TexelTask& task) {
    const int side = task.dataset.has_grid() ? 0 : task.options.surface_side;
    const std::string key = record_key(task.dataset, task.request, task.views, std::to_string(side), "texel");
    const auto write = [&](const fs::path& folder) {
        const Distributors distributors = make_distributors(*task.out.atlas, task.request);
        task.out.records = write_texel_records(folder, task.dataset, *task.out.atlas, task.views,
                                               distributors.workers(), task.request.sort_memory, key);
    };
    with_records(task.dataset, task.request, task.out.times, write, [&](const fs::path& folder) {
        const auto source = open_texel_records(folder, key, task.out.atlas->texel_count(), task.views);
        task.out.samples = source->sample_count();
        note_page_cache(BlockFile::file(folder), task.request, task.out);
        task.out.record_bytes_read = fs::file_size(BlockFile::file(folder));
        solve_source(*source, task, [&](const TexelProblem& problem, const auto& progress) {
            return task.request.levenberg_marquardt()
                       ? by_levenberg_marquardt(problem, task, progress)
                       : task.solvers().solve(problem, task.request.optimizer_options(), progress);
        });
    });
}

namespace {

TexelResult fit_by_ceres(const TexelProblem& problem, const TexelTask& task, CeresTexelOptions::Method method,
                         const std::function<void()>& progress) {
    const TexelModel& model = *task.options.model;
    std::vector<std::unique_ptr<CeresTexelSolver>> solvers;
    for (int i = 0; i < thread_count(); ++i)
        solvers.push_back(ceres_texel_solver(model, {.method = method, .iterations = task.request.iterations}));
    const size_t texels = problem.source.texel_count(), n = size_t(model.parameters);
    TexelResult out;
    out.parameters.resize(texels * n);
    out.status.assign(texels, Status::no_samples);
    out.iterations.assign(texels, 0);
    out.samples.assign(texels, 0);
    const double load_s =
        for_eights(problem, progress, [&](int worker, size_t first, size_t count, const auto& shaded) {
            const std::vector<float> start = task.solvers().start(shaded);
            for (size_t i = 0; i < count; ++i) {
                const size_t t = first + i;
                const CeresTexelFit fit = solvers[size_t(worker)]->solve(shaded[i], {&start[i * n], n});
                std::copy(fit.parameters.begin(), fit.parameters.end(), &out.parameters[t * n]);
                out.iterations[t] = uint32_t(fit.iterations);
                out.samples[t] = uint32_t(shaded[i].size());
                out.status[t] = shaded[i].empty() ? Status::no_samples : fit.status;
            }
        });
    out.error = task.solvers().errors(problem, out.parameters, &out.load_s);
    out.load_s += load_s;
    for (size_t t = 0; t < texels; ++t) out.sample_iterations += uint64_t(out.samples[t]) * out.iterations[t];
    return out;
}

void solve_by_ceres(TexelTask& task, CeresTexelOptions::Method method) {
    with_samples(task, [&](const TexelSource& source) {
        solve_source(source, task, [&](const TexelProblem& problem, const auto& progress) {
            return fit_by_ceres(problem, task, method, progress);
        });
    });
}

}  // namespace

void solve_texel_ceres(TexelTask& task) { solve_by_ceres(task, CeresTexelOptions::Method::whole); }
void solve_texel_ceres_varpro(TexelTask& task) { solve_by_ceres(task, CeresTexelOptions::Method::projected); }
void solve_texel_tiny(TexelTask& task) { solve_by_ceres(task, CeresTexelOptions::Method::tiny); }
void solve_texel_tiny_pack(TexelTask& task) { solve_by_ceres(task, CeresTexelOptions::Method::tiny_pack); }

SharedTexels distribute_texels(const Dataset& dataset, const FitRequest& request, const std::vector<uint32_t>& views) {
    return gather(dataset, *texel_atlas(dataset, request.model.surface_side), request, views);
}

ReflectanceOutcome solve_reflectance(const Dataset& dataset, const FitRequest& asked,
                                     const IterationHook& each_iteration, const std::vector<uint32_t>* views,
                                     const SharedTexels* samples) {
    asked.check();
    require_lights(dataset);
    FitRequest request = asked;
    request.space = TargetSpace::linear;  // the only one that reflectance has
    const std::vector<uint32_t> training = views ? *views : fitted_views(dataset, request);
    Stopwatch clock;
    ReflectanceOutcome out;
    TexelTask task{dataset, request, training, each_iteration, samples, request.texel_options(), out};
    out.atlas = texel_atlas(dataset, task.options.surface_side);
    find_solver(request.solver).solve_texels(task);
    if (!request.part && std::all_of(out.fit.samples.begin(), out.fit.samples.end(), [](uint32_t n) { return n == 0; }))
        throw UserError(
            fmt::format("{}: no sample is left to fit; choose a larger --clip-above or a smaller "
                        "--shadow-below, and check that lamps and cameras stand before the surface",
                        dataset.folder.string()));
    out.fit.options = task.options;
    describe_request(request, out.fit);
    set_dataset(out.fit, dataset);
    out.times.total = clock.wall_s() - out.times.outside;
    return out;
}

}  // namespace radiafit::fits
