#include <fmt/format.h>

#include "app/choices.h"
#include "app/solver.h"
#include "base/atomic_file.h"
#include "base/clock.h"
#include "base/hash.h"
#include "base/log.h"
#include "cpu/two_step_solver.h"
#include "dataset/dataset_json.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

/// Of the pixels, and of what says which of them count.
uint64_t image_checksum(const Dataset& dataset) {
    const InputFile file(dataset.folder / dataset_images_name);
    std::vector<uint8_t> part(size_t(1) << 20);
    uint64_t hash = hash_bytes(nullptr, 0);
    for (uint64_t at = 0, size = file.size(); at < size; at += part.size()) {
        part.resize(std::min<uint64_t>(part.size(), size - at));
        file.read(part.data(), at, part.size());
        hash = hash_bytes(part.data(), part.size(), hash);
    }
    for (const View& view : dataset.views) {
        const double meaning[] = {double(view.pixel_offset), view.mask_offset ? double(*view.mask_offset) : -1.0,
                                  view.peak};
        hash = hash_bytes(meaning, sizeof meaning, hash);
    }
    return hash;
}

/// All that decides what records hold that are to stay.
std::string record_key(const FitTask& task) {
    if (task.request.records.empty()) return "";
    return fmt::format("dataset {}, images {:016x}, views {:016x}, surface side {}, {}, {} records, distributor {}",
                       fingerprint(task.dataset).digest, image_checksum(task.dataset),
                       hash_bytes(task.views.data(), task.views.size() * sizeof(uint32_t)), task.atlas.side(),
                       task.request.space, task.request.record, task.request.distributor);
}

void distribute_to(const fs::path& folder, const std::string& key, FitTask& task) {
    const Distributors distributors = make_distributors(task.atlas, task.request);
    task.out.records = write_records(folder, task.dataset, task.atlas, task.rings, task.views, distributors.workers(),
                                     {.kind = choose_record(task.request.record),
                                      .space = choose_space(task.request.space),
                                      .memory = task.request.memory_bytes(),
                                      .key = key});
}

void solve_from(const fs::path& folder, const std::string& key, FitTask& task) {
    FitOutcome& out = task.out;
    const DiskRecords records(folder, key);
    {
        const Stopwatch outside;
        if (task.request.cold) drop_from_cache(DiskRecords::file(folder));
        out.record_cached_share = cached_share(DiskRecords::file(folder));
        out.times.outside += outside.wall_s();
    }
    Stopwatch clock;
    Progress progress("vertices", records.vertex_count());
    TwoStepResult result = solve_two_step(
        task.dataset, task.atlas, task.rings, records, task.options,
        {.optimizer = task.request.optimizer_options(), .deflate = task.request.deflate, .seed = task.request.seed},
        [&] { progress.advance(); });
    progress.finish();
    if (out.records.bytes_written == 0) log_info(fmt::format("records of an earlier run: {}", folder.string()));
    if (!result.statistics.any()) reject_unseen(task.dataset);
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
    const std::string key = record_key(task);
    if (keep && fs::exists(folder)) return solve_from(folder, key, task);
    if (request.cold) {
        const Stopwatch outside;
        drop_from_cache(task.dataset.folder / dataset_images_name);
        task.out.times.outside += outside.wall_s();
    }
    Stopwatch clock;
    AtomicFolder records(folder, AtomicFolder::Existing::replace);  // goes again, unless it is to stay
    distribute_to(records.path(), key, task);
    task.out.times.distribution = clock.wall_s();
    if (!keep || fs::exists(folder)) return solve_from(records.path(), key, task);  // another run was faster
    records.commit();
    solve_from(folder, key, task);
}

}  // namespace radiafit
