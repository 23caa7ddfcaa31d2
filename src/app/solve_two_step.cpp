#include <fmt/format.h>

#include "app/choices.h"
#include "app/solver.h"
#include "base/atomic_file.h"
#include "base/clock.h"
#include "base/log.h"
#include "cpu/two_step_solver.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

/// All that decides what records hold.
std::string record_key(const FitTask& task) {
    return fmt::format("dataset {}, {} views, surface side {}, {}, {} records, distributor {}",
                       fingerprint(task.dataset).digest, task.views.size(), task.atlas.side(), task.request.space,
                       task.request.record, task.request.distributor);
}

void distribute_to(const fs::path& folder, FitTask& task) {
    const Distributors distributors = make_distributors(task.atlas, task.request);
    task.out.records = write_records(folder, task.dataset, task.atlas, task.rings, task.views, distributors.workers(),
                                     {.kind = choose_record(task.request.record),
                                      .space = choose_space(task.request.space),
                                      .memory = task.request.memory_bytes(),
                                      .key = record_key(task)});
}

void solve_from(const fs::path& folder, FitTask& task) {
    FitOutcome& out = task.out;
    if (task.request.cold) drop_from_cache(DiskRecords::file(folder));
    out.record_cached_share = cached_share(DiskRecords::file(folder));
    Stopwatch clock;
    const DiskRecords records(folder, record_key(task));
    Progress progress("vertices", records.vertex_count());
    TwoStepResult result = solve_two_step(
        task.dataset, task.atlas, task.rings, records, task.options,
        {.optimizer = task.request.optimizer_options(), .deflate = task.request.deflate, .seed = task.request.seed},
        [&] { progress.advance(); });
    progress.finish();
    if (out.records.bytes_written == 0) log_info(fmt::format("records of an earlier run: {}", folder.string()));
    if (std::all_of(result.statistics.samples.begin(), result.statistics.samples.end(),
                    [](uint32_t n) { return n == 0; }))
        reject_unseen(task.dataset);
    out.times.streaming = result.read_s;
    out.times.optimization = clock.wall_s() - result.read_s;
    out.trace = std::move(result.trace);
    out.record_bytes_read = result.bytes_read;
    out.sample_iterations = result.sample_iterations;
    out.working_set_bytes = result.largest_working_set;
    fill_outcomes(task, task.layout(), result.statistics, result.outcomes, std::move(result.parameters));
}

}  // namespace

void solve_two_step(FitTask& task) {
    const FitRequest& request = task.request;
    const bool keep = !request.records.empty();
    const fs::path scratch = request.scratch.empty() ? fs::temp_directory_path() : request.scratch;
    const fs::path folder = keep ? fs::path(request.records) : scratch / "radiafit-records";
    if (keep && fs::exists(folder)) return solve_from(folder, task);
    Stopwatch clock;
    AtomicFolder records(folder, AtomicFolder::Existing::replace);  // goes again, unless it is to stay
    distribute_to(records.path(), task);
    if (keep) records.commit();
    task.out.times.distribution = clock.wall_s();
    solve_from(keep ? folder : records.path(), task);
}

}  // namespace radiafit
