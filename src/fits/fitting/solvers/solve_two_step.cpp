#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/clock.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/read_file.h"
#include "cpu/two_step_solver.h"
#include "dataset/checksums.h"
#include "dataset/dataset_json.h"
#include "fit/fit_json.h"
#include "fitting/solvers/solver.h"
#include "samples/interpolated_samples.h"

namespace radiafit::fits {
namespace {

namespace fs = std::filesystem;

/// Over the pixels, and over what says which of them count.
uint64_t image_checksum(const Dataset& dataset) {
    uint64_t hash = file_checksum(dataset.folder / dataset_images_name);
    for (const View& view : dataset.views) {
        const double meaning[] = {double(view.pixel_offset), view.mask_offset ? double(*view.mask_offset) : -1.0,
                                  view.peak};
        hash = hash_bytes(meaning, sizeof meaning, hash);
    }
    return hash;
}

void distribute_to(const fs::path& folder, const std::string& key, FitTask& task) {
    const FitRequest& request = task.request;
    const RecordOptions options = {
        .kind = request.record, .space = request.space, .memory = request.sort_memory, .key = key};
    const auto write_from = [&](auto&& samples) {
        task.out.records = write_records(folder, task.dataset, task.atlas, task.rings, task.views, samples, options);
    };
    if (request.surface == SurfaceLookup::linear)
        return write_from(InterpolatedSampler(task.dataset, task.atlas, request.space));
    write_from(make_distributors(task.atlas, request).workers());
}

void solve_from(const fs::path& folder, const std::string& key, FitTask& task) {
    FitOutcome& out = task.out;
    const DiskRecords records(folder, key);
    records.require(task.rings.vertex_count(), task.views);
    note_page_cache(BlockFile::file(folder), task.request, out);
    Stopwatch clock;
    Progress progress("vertices", records.vertex_count());
    TwoStepResult result = solve_two_step(task.dataset, task.atlas, task.rings, records, task.options,
                                          task.request.vertex_solver_options(), [&] { progress.advance(); });
    progress.finish();
    out.times.streaming = result.read_s;
    out.times.optimization = clock.wall_s() - result.read_s;
    out.record_bytes_read = result.bytes_read;
    take_solution(task, std::move(result));
}

}  // namespace

std::string record_key(const Dataset& dataset, const FitRequest& request, const std::vector<uint32_t>& views,
                       const std::string& sides, const std::string& kind) {
    if (request.records.empty()) return "";
    return fmt::format(
        "dataset {}, images {:016x}, views {:016x}, surface side {}, {}, {} records, {}", fingerprint(dataset).digest,
        image_checksum(dataset), hash_bytes(views.data(), views.size() * sizeof(uint32_t)), sides,
        request.text("space"), kind,
        request.surface == SurfaceLookup::linear ? "interpolated" : "distributor " + request.text("distributor"));
}

void note_page_cache(const fs::path& records, const FitRequest& request, FitRun& run) {
    const Stopwatch outside;
    if (request.cold) drop_from_cache(records);
    run.record_cached_share = cached_share(records);
    run.times.outside += outside.wall_s();
}

void with_records(const Dataset& dataset, const FitRequest& request, FitTimes& times,
                  const std::function<void(const fs::path&)>& write, const std::function<void(const fs::path&)>& read) {
    const bool keep = !request.records.empty();
    const fs::path scratch = request.scratch.empty() ? fs::temp_directory_path() : request.scratch;
    const fs::path folder = keep ? fs::path(request.records) : scratch / "radiafit-records";
    if (keep && path_exists(folder)) {
        read(folder);
        return log_info(fmt::format("records of an earlier run: {}", folder.string()));
    }
    if (request.cold) {
        const Stopwatch outside;
        drop_from_cache(dataset.folder / dataset_images_name);
        times.outside += outside.wall_s();
    }
    Stopwatch clock;
    AtomicFolder records(folder, AtomicFolder::Existing::replace);  // removed at the end, unless it is to stay
    write(records.path());
    times.distribution = clock.wall_s();
    if (!keep || path_exists(folder)) return read(records.path());  // another run was faster
    records.commit();
    read(folder);
}

void solve_two_step(FitTask& task) {
    std::string sides = std::to_string(task.options.surface_side);
    if (const auto& own = task.options.sides) sides = "its own, " + checksum_of(*own);
    const std::string key = record_key(task.dataset, task.request, task.views, sides, task.request.text("record"));
    with_records(
        task.dataset, task.request, task.out.times, [&](const fs::path& folder) { distribute_to(folder, key, task); },
        [&](const fs::path& folder) { solve_from(folder, key, task); });
}

}  // namespace radiafit::fits
