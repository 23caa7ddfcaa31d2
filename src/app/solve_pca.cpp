#include "app/choices.h"
#include "app/solver.h"
#include "base/clock.h"
#include "reference/pca_solver.h"

namespace radiafit {

void solve_pca(FitTask& task) {
    Stopwatch clock;
    const TileViews tiles = resample_tiles(task.dataset, task.atlas, task.views, choose_space(task.request.space));
    const double distribution = clock.wall_s();
    PcaFit fit = pca_solver(task.dataset, task.atlas, task.rings, task.layout(), tiles);
    task.out.times.optimization = clock.wall_s() - distribution;
    fill_problems(task, std::move(fit.parameters), Status::stationary, 0);
    task.out.times.distribution += distribution;
}

}  // namespace radiafit
