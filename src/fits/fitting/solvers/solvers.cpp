#include <fmt/format.h>

#include <algorithm>

#include "base/choose.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/parallel.h"
#include "cpu/lfm_problem.h"
#include "cpu/texel_solver.h"
#include "cpu/vertex_solver.h"
#include "fitting/solvers/solver.h"
#include "model/penalty.h"
#include "reference/ceres_options.h"
#include "reference/mean_solver.h"

namespace radiafit::fits {

FitTask::FitTask(const Dataset& dataset, const FitRequest& request, const TriangleAtlas& atlas,
                 const VertexRings& rings, const std::vector<uint32_t>& views, const IterationHook& each_iteration,
                 const SharedSamples* shared, FitOutcome& out)
    : dataset(dataset),
      request(request),
      atlas(atlas),
      rings(rings),
      views(views),
      each_iteration(each_iteration),
      options(request.model_options()),
      out(out),
      shared_(shared) {}

const SampleList& FitTask::samples() {
    if (!shared_) {
        own_ = distribute(dataset, atlas, request, views);
        shared_ = &*own_;
        out.times.distribution = own_->seconds;
    }
    out.distribution = shared_->statistics;
    return shared_->list;
}

const TexelSolvers& TexelTask::solvers() const { return texel_solvers(*options.model); }
TexelFitOptions TexelTask::fit_options() const { return {.iterations = request.iterations}; }

LfmLayout FitTask::layout() const { return LfmLayout(rings, atlas, options.view_side, options.terms); }

void fill_outcomes(FitTask& task, const LfmLayout& layout, const ProblemStatistics& statistics,
                   std::span<const ProblemOutcome> outcomes, std::vector<float> parameters) {
    LightFieldFit& fit = task.out.fit;
    fit.parameters = std::move(parameters);
    for (auto* list : {&fit.iterations, &fit.samples}) list->assign(outcomes.size(), 0);
    fit.status.assign(outcomes.size(), Status::no_samples);
    fit.error.assign(outcomes.size(), 0.0f);
    const MapNeighbours view = MapNeighbours::square(task.options.view_side);
    parallel_for(layout.problem_count(), 64, [&](size_t v, int) {
        std::array<double, 3> penalty{};
        if (statistics.samples[v])
            penalty = penalty_error(layout, task.options, view, v, fit.parameters, {&statistics.mean[3 * v], 3});
        for (size_t c = 0; c < 3; ++c) {
            const size_t i = 3 * v + c;
            fit.status[i] = outcomes[i].status;
            fit.iterations[i] = outcomes[i].iterations;
            fit.samples[i] = statistics.samples[v];
            if (!statistics.samples[v]) continue;
            // the engine's error is E / S-bar plus the penalties; problems.exr wants E itself
            const double data = std::max(0.0, outcomes[i].error - penalty[c]);
            const double ring_texels = double(layout.surface_texels(v));
            fit.error[i] =
                float(task.options.corrections.normalized ? data * statistics.samples[v] / ring_texels : data);
        }
    });
}

void take_solution(FitTask& task, VertexSolution&& solution) {
    require_seen(solution.statistics.any(), task.dataset, task.request);
    task.out.trace = std::move(solution.trace);
    task.out.sample_iterations = solution.sample_iterations;
    task.out.working_set_bytes = solution.largest_working_set;
    fill_outcomes(task, task.layout(), solution.statistics, solution.outcomes, std::move(solution.parameters));
}

void fill_problems(FitTask& task, std::vector<float> parameters, Status status, uint32_t iterations) {
    LfmOptions data_only = task.options;
    data_only.lambda_surface = data_only.lambda_view = data_only.mu = 0;
    LfmProblem<float> problem(task.dataset, task.atlas, task.rings, task.samples(), data_only);
    const ProblemStatistics statistics = problem.count();
    const LfmLayout& layout = problem.layout();
    LightFieldFit& fit = task.out.fit;
    const size_t problems = 3 * layout.problem_count();
    fit.status.assign(problems, Status::no_samples);
    fit.iterations.assign(problems, 0);
    fit.samples.assign(problems, 0);
    fit.error.assign(problems, 0.0f);
    std::vector<Lanes<float>> p, gradient;
    for (size_t v = 0; v < layout.problem_count(); ++v) {
        if (!statistics.samples[v]) continue;
        const size_t size = layout.block_size(v) / 4;
        p.resize(size);
        gradient.resize(size);
        for (size_t i = 0; i < size; ++i)
            for (int c = 0; c < 4; ++c) p[i][c] = parameters[layout.offset(v) + 4 * i + size_t(c)];
        double error[3];
        problem.direction(v, p.data(), gradient.data(), nullptr, error);
        for (size_t c = 0; c < 3; ++c) {
            fit.status[3 * v + c] = status;
            fit.iterations[3 * v + c] = iterations;
            fit.samples[3 * v + c] = statistics.samples[v];
            fit.error[3 * v + c] = float(error[c] * statistics.samples[v] / double(problem.texels(v)));
        }
    }
    fit.parameters = std::move(parameters);
}

void solve_mean(FitTask& task) {
    task.options.terms = 1;
    task.options.view_side = 2;
    const SampleList& samples = task.samples();
    Stopwatch clock;
    std::vector<float> parameters = mean_solver(task.atlas, task.layout(), samples);
    task.out.times.optimization = clock.wall_s();
    fill_problems(task, std::move(parameters), Status::stationary, 0);
}

/// Bytes of an optimizer over one vertex: vectors and states; its samples are few beside them.
static uint64_t vertex_work(const FitRequest& request, const VertexShape& vertex) {
    const LfmOptions& m = request.model;
    const size_t texels = vertex.maps * TriangleTile::texels_of(m.surface_side) + size_t(m.view_side * m.view_side);
    return vertex_solver_bytes(texels, vertex.samples, m.terms, room_of(request.optimizer_options()));
}

std::span<const Solver> solvers() {
    constexpr SolverFacts streamed = {.iterates = true, .objective = true, .optimizer = true, .on_engine = true};
    constexpr SolverFacts in_two_steps = {
        .iterates = true, .objective = true, .optimizer = true, .list = true, .records = true};
    constexpr SolverFacts vertex_by_vertex = {.iterates = true, .objective = true, .list = true};
    constexpr SolverFacts by_ceres = {.iterates = true, .objective = true, .list = true, .ceres = true};
    constexpr SolverFacts texel_by_texel = {.iterates = true, .list = true, .most_parameters = most_ceres_parameters};
    static constexpr Solver table[] = {
        {.name = "stream",
         .help = "the paper's optimizers over --engine",
         .solve = solve_stream,
         .facts = streamed,
         .solve_texels = solve_texel_stream,
         .texel_facts = streamed,
         .vertex_bytes = vertex_work},
        {.name = "two-step",
         .help = "distributed to disk first, then vertex by vertex (Section 4.3)",
         .solve = solve_two_step,
         .facts = in_two_steps,
         .solve_texels = solve_texel_two_step,
         .texel_facts = in_two_steps,
         .vertex_bytes = vertex_work},
        {.name = "pca",
         .help = "factorization of the resampled light field, Chen et al. 2002",
         .solve = solve_pca,
         .facts = SolverFacts{.resamples = true},
         .vertex_bytes = [](const FitRequest& r, const VertexShape& v) { return pca_bytes(r.model, v); }},
        {.name = "ceres",
         .help = "the Ceres library, vertex by vertex",
         .solve = solve_ceres,
         .facts = by_ceres,
         .solve_texels = solve_texel_ceres,
         .texel_facts = texel_by_texel,
         .vertex_bytes =
             [](const FitRequest& r, const VertexShape& v) {
                 return ceres_bytes(r.model, v, find_ceres_setting(r.ceres).memory);
             }},
        {.name = "ceres-varpro",
         .help = "variable projection by hand, what is left given to Ceres, texel by texel",
         .solve_texels = solve_texel_ceres_varpro,
         .texel_facts = texel_by_texel},
        {.name = "tinysolver",
         .help = "Ceres' TinySolver, texel by texel",
         .solve_texels = solve_texel_tiny,
         .texel_facts = texel_by_texel},
        {.name = "tinysolver-float",
         .help = "the same in 32-bit floats, eight samples of a texel side by side",
         .solve_texels = solve_texel_tiny_pack,
         .texel_facts = texel_by_texel},
        {.name = "als",
         .help = "alternating least squares, vertex by vertex",
         .solve = solve_als,
         .facts = vertex_by_vertex,
         .vertex_bytes = [](const FitRequest& r, const VertexShape& v) { return als_bytes(r.model, v); }},
        {.name = "varpro",
         .help = "variable projection, vertex by vertex",
         .solve = solve_varpro,
         .facts = vertex_by_vertex,
         .vertex_bytes = [](const FitRequest& r, const VertexShape& v) { return varpro_bytes(r.model, v); }},
        {.name = "mean",
         .help = "the trivial baseline: one mean colour per texel",
         .solve = solve_mean,
         .facts = SolverFacts{.list = true, .mean_colours = true},
         .halo = 1},
    };
    return table;
}

const Solver& find_solver(const std::string& name) {
    std::vector<std::string> names;
    for (const Solver& solver : solvers()) {
        if (solver.name == name) return solver;
        names.emplace_back(solver.name);
    }
    reject_name("solver", name, names);
}

}  // namespace radiafit::fits
