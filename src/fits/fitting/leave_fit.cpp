#include "fitting/leave_fit.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "dataset/checksums.h"
#include "fitting/baseline_check.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"

namespace radiafit::fits {
namespace {

/// A fit's times and provenance, as JSON, into it.
nlohmann::ordered_json describe_run(FitRecord& fit, const FitRun& run, const FitRequest& request, Record record) {
    record.gl_vendor = run.gl_vendor;
    record.gl_renderer = run.gl_renderer;
    record.gl_version = run.gl_version;
    fit.provenance_json = record_json(record);
    const FitTimes& t = run.times;
    nlohmann::ordered_json times = {
        {"distribution_s", t.distribution},
        {"streaming_s", t.streaming},
        {"optimization_s", t.optimization},
        {"total_s", t.total},
        {"sweep_cpu_ms_per_image", run.sweep_cpu_ms_per_image},
        {"unaccounted_s", t.total - t.distribution - t.streaming - t.optimization},
    };
    if (!run.accumulation.empty()) times["accumulation"] = run.accumulation;
    if (run.group_size) times["group_size"] = run.group_size;
    if (facts_of(request).records)
        times["records"] = {
            {"bytes_written", run.records.bytes_written}, {"waiting_bytes_read", run.records.bytes_read},
            {"waiting_parts", run.records.waiting_parts}, {"bytes_read", run.record_bytes_read},
            {"cached_share", run.record_cached_share},    {"sample_iterations", run.sample_iterations},
            {"working_set_bytes", run.working_set_bytes},
        };
    return times;
}

/// "cg-modern in 3.2 s: error 1 -> 0.1 (all 25 iterations used, the last lowered the error by 0.02 %), ".
std::string summary_of(const FitRun& run, const FitRequest& request, const FitRecord& fit) {
    const auto counts = fit.status_counts();
    const uint64_t problems = fit.status.size() - counts[size_t(Status::no_samples)];
    std::string line = fmt::format("{} in {:.1f} s: ", request.label(), run.times.total);
    if (run.trace.rows.empty()) return line;
    line += fmt::format("error {:.6g} -> {:.6g}", run.trace.rows.front().error, run.trace.rows.back().error);
    const std::string ending = ending_of(run.trace, counts[size_t(Status::max_iterations)], problems);
    return line + (ending.empty() ? ", " : fmt::format(" ({}), ", ending));
}

constexpr double usual_unseen = 0.2;  // of the surface: undersides, hollows, what stood on the ground

/// "212 of 4096 texels in no photograph": what of the surface no sample shows, and whether that is bad.
std::string unseen_part(const FitRecord& record, const FitRequest& request, bool over_grid) {
    const bool vertices = family_of(request).kind == ModelKind::light_field;  // with a problem for each channel
    const size_t each = vertices ? 3 : 1, all = record.status.size() / each;
    const size_t unseen = record.status_counts()[size_t(Status::no_samples)] / each;
    const std::string what = fmt::format("{} of {} {}", unseen, all, vertices ? "vertices" : "texels");
    if (over_grid && unseen > 0) return what + " outside the mask, or in no image";
    if (unseen == 0) return fmt::format("photographs show all {} {}", all, vertices ? "vertices" : "texels");
    if (double(unseen) <= usual_unseen * double(all))
        return what + " in no photograph, which is usual: undersides, hollows";
    return what + " in no photograph, which is much: photograph those sides too, or cut them off the mesh";
}

/// What a fit came to, on standard output.
void print_json(const std::string& out, const FinishedFit& done, const FitRequest& request) {
    const FitRecord& record = done.fit.record();
    const auto counts = record.status_counts();
    nlohmann::ordered_json json = {{"fit", out},
                                   {"model", request.text("model")},
                                   {"solver", request.label()},
                                   {"seconds", done.run.times.total},
                                   {"problems", record.status.size()},
                                   {"without_samples", counts[size_t(Status::no_samples)]},
                                   {"not_finite", counts[size_t(Status::not_finite)]}};
    if (const auto& rows = done.run.trace.rows; !rows.empty()) {
        json["error_at_start"] = rows.front().error;
        json["error"] = rows.back().error;
    }
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace

Record begin_record(const Dataset& dataset, int argc, const char* const* argv) {
    Record begun = make_record(argc, argv);
    begun.datasets->push_back(dataset_note(dataset));
    return begun;
}

void require_result(const FitRecord& fit, const Dataset& dataset) {
    const auto counts = fit.status_counts();
    const uint64_t broken = counts[size_t(Status::not_finite)], empty = counts[size_t(Status::no_samples)];
    if (broken > 0 && broken + empty == fit.status.size())
        throw UserError(
            fmt::format("{}: none of {} problems came to a finite result ({} have no samples): check the "
                        "images' values, gains and lights",
                        dataset.folder.string(), fit.status.size(), empty));
}

void save_fit(const std::filesystem::path& folder, FinishedFit& done, const FitRequest& request, const Record& begun) {
    FitRecord& fit = done.fit.record();
    auto times = describe_run(fit, done.run, request, begun);
    if (!done.times_json.empty()) times.update(nlohmann::ordered_json::parse(done.times_json));
    fit.times_json = times.dump();
    write_fit(folder, done.fit, [&](const std::filesystem::path& inside) {
        write_file(inside / "trace.csv", trace_csv(done.run.trace, request.label(), fit.engine));
        write_error_bars(inside, done.fit);
    });
}

void leave(const FitTarget& target, const Dataset& dataset, const FitRequest& request, FinishedFit done,
           const Record& begun) {
    const FitRecord& record = done.fit.record();
    require_result(record, dataset);
    if (target.covariance) find_error_bars(done.fit, {});
    save_fit(target.out, done, request, begun);
    if (target.json)
        print_json(target.out, done, request);
    else
        log_info(fmt::format("{} {}{}{}; {} not finite; see {}", request.text("model"),
                             summary_of(done.run, request, record), done.note,
                             unseen_part(record, request, dataset.has_grid()),
                             record.status_counts()[size_t(Status::not_finite)], target.out));
    if (!target.check) return;
    const auto check = check_against_baseline(done.fit);
    if (check && check->baseline_is_better())
        log_warning(fmt::format("{}: {}", target.out, describe_baseline(*check, done.fit)));
}

}  // namespace radiafit::fits
