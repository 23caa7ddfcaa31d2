#include "base/clock.h"
#include "base/log.h"
#include "fitting/solvers/solver.h"
#include "reference/pca_solver.h"

namespace radiafit::fits {

void solve_pca(FitTask& task) {
    FitTask* const one[] = {&task};
    solve_pca(one);
}

void solve_pca(std::span<FitTask* const> tasks) {
    FitTask& first = *tasks.front();
    for (FitTask* task : tasks) task->samples();  // what errors are counted over; refuses a dataset that no view sees
    Stopwatch clock;
    const TileViews tiles = resample_tiles(first.dataset, first.atlas, first.views, first.request.space);
    const RingResampler resampler(first.dataset, first.atlas, first.rings, tiles, first.options.view_side);
    const double resampled_s = clock.wall_s();
    Stopwatch optimization;
    const LfmLayout layout = first.layout();
    std::vector<int> refills;
    for (const FitTask* task : tasks) refills.push_back(task->request.refills);
    Progress progress("vertices", layout.problem_count());
    std::vector<PcaFit> fits = pca_solver(resampler, layout, refills, [&] { progress.advance(); });
    progress.finish();
    for (size_t i = 0; i < tasks.size(); ++i) {
        FitOutcome& out = tasks[i]->out;
        out.times.distribution += resampled_s;
        out.times.optimization = optimization.wall_s();
        out.resampling = fits[i].resampling;
        fill_problems(*tasks[i], std::move(fits[i].parameters), Status::stationary, 0);
    }
}

}  // namespace radiafit::fits
