// Reference solvers that take one vertex after another, from a sample list: Ceres, alternating least squares, variable
// projection.
#include <algorithm>

#include "base/clock.h"
#include "base/log.h"
#include "base/parallel.h"
#include "fitting/solvers/solver.h"
#include "reference/als_solver.h"
#include "reference/ceres_solver.h"
#include "reference/varpro_solver.h"

namespace radiafit::fits {
namespace {

void solve_by_vertices(FitTask& task, const VertexSolver& solver) {
    const SampleList& samples = task.samples();
    Stopwatch clock;
    const LfmVertices vertices(task.dataset, task.atlas, task.rings, samples, task.options);
    Progress progress("vertices", vertices.layout().problem_count());
    RunsResult result = solve_vertices(vertices, task.request.seed,
                                       [&](const LfmVertex& vertex, std::span<Lanes<double>> p, VertexRun& run) {
                                           solver(vertex, p, run);
                                           progress.advance();
                                       });
    progress.finish();
    FitOutcome& out = task.out;
    out.times.optimization = clock.wall_s();
    out.trace = trace_of(result.runs, thread_count());
    std::vector<ProblemOutcome> outcomes;
    for (const VertexRun& run : result.runs)
        for (const VertexRun::Channel& c : run.channel)
            outcomes.push_back({c.error.empty() ? 0.0f : float(c.error.back()), c.status, c.iterations()});
    fill_outcomes(task, vertices.layout(), vertices.statistics(), outcomes, std::move(result.parameters));
    for (size_t k = 0; task.each_iteration && k < out.trace.rows.size(); ++k)
        task.each_iteration(int(k), [&](std::span<float> errors) {
            for (size_t i = 0; i < errors.size(); ++i) {
                const std::vector<double>& rows = result.runs[i / 3].channel[i % 3].error;
                errors[i] = rows.empty() ? 0.0f : float(rows[std::min(k, rows.size() - 1)]);
            }
        });
}

}  // namespace

void solve_ceres(FitTask& task) {
    solve_by_vertices(task, ceres_solver(task.options, {.setting = task.request.ceres,
                                                        .iterations = task.request.iterations,
                                                        .stop_residual = task.request.stop_residual}));
}

void solve_als(FitTask& task) {
    solve_by_vertices(task, als_solver(task.options, {.iterations = task.request.iterations,
                                                      .stop_residual = task.request.stop_residual}));
}

void solve_varpro(FitTask& task) {
    solve_by_vertices(task, varpro_solver(task.options, {.iterations = task.request.iterations,
                                                         .stop_residual = task.request.stop_residual}));
}

}  // namespace radiafit::fits
