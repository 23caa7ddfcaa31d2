// fit: its options, what it runs, what it leaves.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/fit_options.h"
#include "app/solver.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "base/record.h"
#include "base/resources.h"
#include "cpu/texel_fit.h"

namespace radiafit {

void add_fit_options(CommandLine& c, FitRequest& r) {
    for (const FitOption& o : fit_options()) {
        const std::string help = o.type == "NAME" ? o.values + ": " + o.help : o.help;
        if (o.flag_value)
            c.add_flag(o.flag, *o.flag_value(r), help).group(o.group);
        else
            c.add(o.flag, o.type, o.hide_default ? "" : o.text(r), help, [&r, &o](const std::string& text) {
                 o.read(r, text);
             }).group(o.group);
    }
}

void settle_options(const CommandLine& command, const Dataset& dataset, FitRequest& request) {
    if (!request.texel_local()) return;
    if (uses_of(request) & use::optimizer && !request.on_fragment_engine() && !command.given("--optimizer"))
        request.optimizer = nullptr;
    if (request.levenberg_marquardt() && !command.given("--iterations"))
        request.iterations = TexelFitOptions().iterations;
    if (!command.given("--surface-side") && !dataset.has_grid())
        request.model.surface_side =
            dataset.normal_map.side > 0 ? dataset.normal_map.side : TexelOptions().surface_side;
}

namespace {

/// Throws UserError if the fit's folder and the records' lie one inside the other.
void check_apart(const std::string& output, const std::string& records) {
    if (records.empty()) return;
    const auto whole = [](const std::string& path) {
        return (std::filesystem::weakly_canonical(std::filesystem::absolute(path)) / "").lexically_normal().string();
    };
    const std::string a = whole(output), b = whole(records);
    if (a.starts_with(b) || b.starts_with(a))
        throw UserError(
            fmt::format("{}: the records' folder and the fit's lie one inside the other; choose another", records));
}

/// A fit's times and provenance, as JSON, into it.
nlohmann::ordered_json describe_run(FitRecord& fit, const FitRun& run, const FitRequest& request,
                                    const Invocation& invocation) {
    Record record = make_record(invocation.argc, invocation.argv);
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
    if (uses_of(request) & use::records)
        times["records"] = {
            {"bytes_written", run.records.bytes_written}, {"waiting_bytes_read", run.records.bytes_read},
            {"waiting_parts", run.records.waiting_parts}, {"bytes_read", run.record_bytes_read},
            {"cached_share", run.record_cached_share},    {"sample_iterations", run.sample_iterations},
            {"working_set_bytes", run.working_set_bytes},
        };
    return times;
}

std::string trace_of(const FitRun& run, const FitRecord& fit, const FitRequest& request) {
    return trace_csv(run.trace, request.label(), fit.engine);
}

/// Throws UserError for a fit that means nothing.
void require_result(const FitRecord& fit, const Dataset& dataset) {
    const auto counts = fit.status_counts();
    const uint64_t broken = counts[size_t(Status::not_finite)], empty = counts[size_t(Status::no_samples)];
    if (broken > 0 && broken + empty == fit.status.size())
        throw UserError(
            fmt::format("{}: none of {} problems came to a finite result ({} have no samples): check the "
                        "images' values, gains and lights",
                        dataset.folder.string(), fit.status.size(), empty));
}

/// Streamed images have 16 bits up to the largest value of all: one hot pixel, or one gain, leaves other images few.
/// Texel-local fits on the CPU read the values themselves.
void warn_about_range(const Dataset& dataset, const FitRequest& request) {
    if (request.texel_local() && !request.on_fragment_engine()) return;
    const bool encoded =
        !request.texel_local() && request.space == TargetSpace::stored && dataset.encoding == Encoding::u8_srgb;
    constexpr double uneven = 256;  // 8 bits are left
    const View *brightest = nullptr, *darkest = nullptr;
    double largest = 0, smallest = 0;
    for (const View& view : dataset.views) {
        const double light = double(view.peak) * view.gain, value = encoded ? srgb_encode(light) : light;
        if (!(value > 0)) continue;
        if (!brightest || value > largest) brightest = &view, largest = value;
        if (!darkest || value < smallest) darkest = &view, smallest = value;
    }
    if (brightest && largest > uneven * smallest)
        log_warning(
            fmt::format("{}: image '{}' goes up to {:.3g}, image '{}' to {:.3g} only: images are streamed with 16 "
                        "bits up to the largest value, so that one keeps less than 8; mend pixels or gains",
                        dataset.folder.string(), brightest->name, largest, darkest->name, smallest));
}

/// Everything a fit leaves, in one folder.
void save(const std::string& folder, const Dataset& dataset, const FitRequest& request, FitOutcome& outcome,
          const Invocation& invocation) {
    auto times = describe_run(outcome.fit, outcome, request, invocation);
    if (const ResamplingCounts& r = outcome.resampling; r.entries)
        times["resampling"] = {
            {"entries", r.entries},
            {"outside_hull", r.outside_hull},
            {"unseen_texels", r.unseen_texels},
            {"invented_share", r.invented_share()},
        };
    outcome.fit.times_json = times.dump();
    write_fit(folder, outcome.fit, dataset.mesh, [&](const std::filesystem::path& inside) {
        write_file(inside / "trace.csv", trace_of(outcome, outcome.fit, request));
    });
}

void save(const std::string& folder, const FitRequest& request, ReflectanceOutcome& outcome,
          const Invocation& invocation) {
    auto times = describe_run(outcome.fit, outcome, request, invocation);
    times["samples"] = outcome.samples;
    outcome.fit.times_json = times.dump();
    write_fit(folder, outcome.fit, *outcome.atlas, [&](const std::filesystem::path& inside) {
        write_file(inside / "trace.csv", trace_of(outcome, outcome.fit, request));
    });
}

/// "cg-modern in 3.2 s: error 1 -> 0.1, ".
std::string summary_of(const FitRun& run, const FitRequest& request) {
    std::string line = fmt::format("{} in {:.1f} s: ", request.label(), run.times.total);
    if (!run.trace.rows.empty())
        line += fmt::format("error {:.6g} -> {:.6g}, ", run.trace.rows.front().error, run.trace.rows.back().error);
    return line;
}
std::string problems_of(const FitRecord& fit) {
    const auto counts = fit.status_counts();
    return fmt::format("{} problems without samples, {} not finite", counts[size_t(Status::no_samples)],
                       counts[size_t(Status::not_finite)]);
}

/// Says what the fit needs, and stops where that is not there.
void announce_plan(const std::string& out, const Dataset& dataset, const FitRequest& request, bool force) {
    constexpr size_t views_to_count_samples_on = 8;
    constexpr uint64_t program_bytes = 150'000'000;  // with its libraries, which `radiafit --version` loads too
    const Plan planned = plan(dataset, request, views_to_count_samples_on);
    announce_needs("fit", {total_bytes(planned.memory) + program_bytes, total_bytes(planned.disk)}, out, force);
}

void fit_light_field(const std::string& out, const Dataset& dataset, const FitRequest& request,
                     const Invocation& invocation) {
    Progress progress("fit", size_t(request.iterations) + 1);
    FitOutcome outcome = solve(dataset, request, nullptr, [&](int, const auto&) { progress.advance(); });
    progress.finish();
    require_result(outcome.fit, dataset);
    save(out, dataset, request, outcome, invocation);
    std::string line = summary_of(outcome, request);
    if (const ResamplingCounts& r = outcome.resampling; r.entries)
        line += fmt::format("{} of {} resampled entries ({:.1f}%) invented, ", r.outside_hull + r.unseen_texels,
                            r.entries, 100 * r.invented_share());
    log_info(fmt::format("{}{}; see {}", line, problems_of(outcome.fit), out));
}

void fit_reflectance(const std::string& out, const Dataset& dataset, const FitRequest& request,
                     const Invocation& invocation) {
    ReflectanceOutcome outcome = solve_reflectance(dataset, request);
    require_result(outcome.fit, dataset);
    save(out, request, outcome, invocation);
    const auto counts = outcome.fit.status_counts();
    log_info(fmt::format("{} {}{} texels, {} underdetermined, {}; see {}", request.kind, summary_of(outcome, request),
                         outcome.fit.problem_count(), counts[size_t(Status::underdetermined)], problems_of(outcome.fit),
                         out));
}

}  // namespace

void add_fit(CommandLine& program, const Invocation& invocation) {
    auto request = std::make_shared<FitRequest>();
    auto folder = std::make_shared<std::string>();
    auto out = std::make_shared<std::string>();
    auto force = std::make_shared<bool>(false);
    CommandLine& command = program.add_command("fit", "fit a model to a packed dataset");
    command.add_text("dataset", *folder, "packed dataset").required();
    add_fit_options(command, *request);
    command.add_text("-o,--output", *out, "folder of the fit").required();
    add_force(command, *force);
    command.on_run([=, &command] {
        request->check();
        check_fit_target(*out);
        AtomicFolder(*out,
                     AtomicFolder::Existing::replace);  // an output that cannot be written shows now, not at the end
        check_apart(*out, request->records);
        request->scratch = (std::filesystem::absolute(*out) / "").parent_path().parent_path();
        if (!request->texel_local()) reject_idle_options(*request, false);
        const Dataset dataset = open_dataset(*folder);
        settle_options(command, dataset, *request);
        reject_idle_options(*request, dataset.has_grid());
        announce_plan(*out, dataset, *request, *force);
        warn_about_range(dataset, *request);
        (request->texel_local() ? fit_reflectance : fit_light_field)(*out, dataset, *request, invocation);
    });
}

}  // namespace radiafit
