#include "reference/als_solver.h"

#include <algorithm>
#include <memory>

#include "reference/half_step.h"

namespace radiafit::fits {
namespace {

using V = Lanes<double>;

}  // namespace

VertexSolver als_solver(const LfmOptions& model, const AlsOptions& options) {
    require_modern_penalty(model, "als");
    const auto tiles = std::make_shared<TileSmoothness>(model);
    const auto view = std::make_shared<Smoothness>(MapNeighbours::square(model.view_side));
    return [=](const LfmVertex& vertex, std::span<V> p, VertexRun& run) {
        JointRows rows(vertex, options.stop_residual, run);
        SurfaceStep solve_surface(vertex, *tiles);
        ViewStep solve_view(vertex, *view);
        std::vector<V> trial(p.begin(), p.end());
        rows.begin(lfm_error(vertex, p.data()));
        for (int k = 0; k < options.iterations && rows.any_active(); ++k) {
            const bool solved = solve_surface(trial.data()) && solve_view(trial.data());
            const V after = lfm_error(vertex, trial.data());
            for (int c = 0; c < 3; ++c) {
                if (!rows.active(c)) continue;
                // An exact half step can't raise E_t but by rounding.
                const double before = rows.error(c);
                const bool lower = solved && after[c] < before;
                if (!lower || before - after[c] <= options.stop_change * before) rows.end(c, Status::stationary);
                for (size_t i = 0; lower && i < p.size(); ++i) p[i][c] = trial[i][c];
                rows.add(c, lower ? after[c] : before);
            }
            std::copy(p.begin(), p.end(), trial.begin());
        }
        rows.finish();
    };
}

}  // namespace radiafit::fits
