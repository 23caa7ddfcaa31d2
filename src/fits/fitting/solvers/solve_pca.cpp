#include "base/clock.h"
#include "base/log.h"
#include "fitting/solvers/solver.h"
#include "reference/pca_solver.h"

namespace radiafit::fits {

void solve_pca(FitTask& task) {
    task.samples();  // what its error is counted over; refuses a dataset that no view sees
    Stopwatch clock;
    const TileViews tiles = resample_tiles(task.dataset, task.atlas, task.views, task.request.space);
    const RingResampler resampler(task.dataset, task.atlas, task.rings, tiles, task.options.view_side);
    task.out.times.distribution += clock.wall_s();
    Stopwatch optimization;
    const LfmLayout layout = task.layout();
    Progress progress("vertices", layout.problem_count());
    PcaFit fit = pca_solver(resampler, layout, task.request.refills, [&] { progress.advance(); });
    progress.finish();
    task.out.times.optimization = optimization.wall_s();
    task.out.resampling = fit.resampling;
    fill_problems(task, std::move(fit.parameters), Status::stationary, 0);
}

}  // namespace radiafit::fits
