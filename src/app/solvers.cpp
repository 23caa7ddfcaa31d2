#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/solver.h"
#include "base/clock.h"
#include "base/error.h"
#include "cpu/lfm_problem.h"
#include "model/penalty.h"
#include "reference/mean_solver.h"

namespace radiafit {

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

LfmLayout FitTask::layout() const {
    return LfmLayout(rings, int(atlas.texels_per_tile()), options.view_side, options.terms);
}

void fill_outcomes(FitTask& task, const LfmLayout& layout, const ProblemStatistics& statistics,
                   std::span<const ProblemOutcome> outcomes, std::vector<float> parameters) {
    LightFieldFit& fit = task.out.fit;
    fit.parameters = std::move(parameters);
    for (auto* list : {&fit.iterations, &fit.samples}) list->assign(outcomes.size(), 0);
    fit.status.assign(outcomes.size(), Status::no_samples);
    fit.error.assign(outcomes.size(), 0.0f);
    for (size_t i = 0; i < outcomes.size(); ++i) {
        const size_t v = i / 3;
        fit.status[i] = outcomes[i].status;
        fit.iterations[i] = outcomes[i].iterations;
        fit.samples[i] = statistics.samples[v];
        if (!statistics.samples[v]) continue;
        // the engine's error is E / S-bar plus the penalties; problems.exr wants E itself
        const double penalty =
            penalty_error(layout, task.options, v, fit.parameters, {&statistics.mean[3 * v], 3})[i % 3];
        const double ring_texels = double(layout.view_offset(v) - layout.offset(v)) / double(layout.stride());
        fit.error[i] = float(std::max(0.0, outcomes[i].error - penalty) * statistics.samples[v] / ring_texels);
    }
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
    std::vector<float> parameters = mean_solver(task.atlas, task.rings, task.layout(), samples);
    task.out.times.optimization = clock.wall_s();
    fill_problems(task, std::move(parameters), Status::stationary, 0);
}

#define MODEL " space terms surface_side view_side view "
#define PENALTY " mode lambda_surface lambda_view mu lower upper "
#define OPTIMIZER " optimizer iterations stop_residual stop_output_change seed deflate "
#define SAMPLES " distributor context device "
#define FRAGMENT " passes storage sums source context device "
std::span<const Solver> solvers() {
    static constexpr Solver table[] = {
        {"stream", "the paper's optimizers over --engine", solve_stream, MODEL PENALTY OPTIMIZER " engine "},
        {"two-step", "distributed to disk first, then vertex by vertex (Section 4.3)", solve_two_step,
         MODEL PENALTY OPTIMIZER SAMPLES " record memory records "},
        {"pca", "factorization of the resampled light field, Chen et al. 2002", solve_pca, MODEL " refills "},
        {"ceres", "the Ceres library, vertex by vertex", solve_ceres,
         MODEL PENALTY SAMPLES " iterations stop_residual seed ceres "},
        {"als", "alternating least squares, vertex by vertex", solve_als,
         MODEL PENALTY SAMPLES " iterations stop_residual seed "},
        {"varpro", "variable projection, vertex by vertex", solve_varpro,
         MODEL PENALTY SAMPLES " iterations stop_residual seed "},
        {"mean", "the trivial baseline: one mean colour per texel", solve_mean, SAMPLES " space surface_side "},
    };
    return table;
}
#undef MODEL
#undef PENALTY
#undef OPTIMIZER

/// Names of FitRequest::json() that mean something to a texel-local model; empty if the solver fits none. Over a grid
/// every texel has its own pixel: there is no side to choose, and nothing to distribute.
std::string texel_options_of(const FitRequest& request, bool grid) {
    const std::string model = std::string(" clip_above shadow_below iterations ") + (grid ? "" : " surface_side ");
    const std::string samples = grid ? "" : SAMPLES;
    const std::string optimizer =
        request.levenberg_marquardt() ? " optimizer " : " optimizer mode mu stop_residual stop_output_change ";
    if (request.solver == "stream")
        return model + optimizer + " engine " + (request.engine == "fragment" ? FRAGMENT : samples);
    if (request.solver == "two-step") return model + optimizer + samples + " memory records ";
    if (request.solver == "ceres") return model + samples;
    return "";
}

void reject_idle_options(const FitRequest& request, bool grid) {
    std::string options, what = "solver " + request.solver;
    for (const Solver& solver : solvers())
        if (request.solver == solver.name) options = solver.options;
    if (request.texel_local()) {
        options = texel_options_of(request, grid);
        if (options.empty())
            throw UserError(
                fmt::format("solver {} fits light field maps only; choose stream, two-step or ceres for --model {}",
                            request.solver, request.kind));
        what = "model " + request.kind + " with " + (request.levenberg_marquardt() ? "optimizer lm" : what);
        if (grid) what += " over a grid";
    } else if (request.solver == "stream") {
        options += request.engine == "fragment" ? FRAGMENT : SAMPLES;
        what = "engine " + request.engine;
    }
    const auto given = nlohmann::json::parse(request.json());
    FitRequest plain;
    plain.mode = request.mode;  // mu's default depends on it
    auto defaults = nlohmann::json::parse(plain.json());
    defaults["mode"] = FitRequest().mode;
    for (const auto& [name, value] : given.items()) {
        if (name == "solver" || name == "model" || name == "validation" || value == defaults.at(name) ||
            options.find(" " + name + " ") != std::string::npos)
            continue;
        std::string option = name == "stop_output_change" ? "stop_change" : name;
        std::replace(option.begin(), option.end(), '_', '-');
        throw UserError(fmt::format("--{} means nothing to {}; leave it out", option, what));
    }
}
#undef SAMPLES
#undef FRAGMENT

}  // namespace radiafit
