#include "reference/als_solver.h"

#include <cmath>
#include <memory>

#include "reference/half_step.h"

namespace radiafit {
namespace {

using V = Lanes<double>;

}  // namespace

VertexSolver als_solver(const LfmOptions& model, const AlsOptions& options) {
    require_modern_penalty(model, "als");
    const auto tile = std::make_shared<Smoothness>(MapNeighbours::triangle(model.surface_side));
    const auto view = std::make_shared<Smoothness>(MapNeighbours::square(model.view_side));
    return [=](const LfmVertex& vertex, std::span<V> p, VertexRun& run) {
        const double start = run.clock();
        SurfaceStep solve_surface(vertex, *tile);
        ViewStep solve_view(vertex, *view);
        std::vector<V> trial(p.begin(), p.end());
        V error = lfm_error(vertex, p.data());
        const double enough = 0.5 * double(vertex.surface_texels()) * options.stop_residual * options.stop_residual;
        run.joint = true;
        for (int c = 0; c < 3; ++c) {
            run.channel[c].status = std::isfinite(error[c]) ? Status::active : Status::not_finite;
            run.channel[c].error = {error[c]};
            run.channel[c].time_s = {run.clock() - start};
        }
        for (int k = 0; k < options.iterations; ++k) {
            bool any = false;
            for (const auto& c : run.channel) any = any || c.status == Status::active;
            if (!any) break;
            const bool solved = solve_surface(trial.data()) && solve_view(trial.data());
            const V after = lfm_error(vertex, trial.data());
            for (int c = 0; c < 3; ++c) {
                VertexRun::Channel& channel = run.channel[c];
                if (channel.status != Status::active) continue;
                // An exact half step can't raise E_t but by rounding.
                const bool lower = solved && after[c] < error[c];
                if (!lower || error[c] - after[c] <= options.stop_change * error[c])
                    channel.status = Status::stationary;
                if (lower) {
                    error[c] = after[c];
                    for (size_t i = 0; i < p.size(); ++i) p[i][c] = trial[i][c];
                }
                if (error[c] <= enough) channel.status = Status::residual;
                channel.error.push_back(error[c]);
                channel.time_s.push_back(run.clock() - start);
            }
            std::copy(p.begin(), p.end(), trial.begin());
        }
        for (auto& c : run.channel)
            if (c.status == Status::active) c.status = Status::max_iterations;
    };
}

}  // namespace radiafit
