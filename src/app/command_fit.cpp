// fit: its options, what it runs, what it leaves.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/commands.h"
#include "app/family.h"
#include "app/fit_on_ranks.h"
#include "app/fit_options.h"
#include "app/parts.h"
#include "app/ranks.h"
#include "app/settle.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "base/record.h"
#include "base/resources.h"
#include "dataset/checksums.h"
#include "eval/outliers.h"

namespace radiafit {

void add_fit_option(CommandLine& c, FitRequest& r, const std::string& name) {
    const FitOption& o = find_fit_option(name);
    const std::string help = o.type == "NAME" ? o.values + ": " + o.help : o.help;
    if (o.flag_value)
        c.add_flag(o.flag, r.*o.flag_value, help).group(o.group);
    else
        c.add(o.flag, o.type, o.hide_default ? "" : o.text(r), help, [&r, &o](const std::string& text) {
             o.read(r, text);
         }).group(o.group);
}

void add_fit_options(CommandLine& c, FitRequest& r) {
    for (const FitOption& o : fit_options()) add_fit_option(c, r, o.name);
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
    if (uses_of(request) & use::records)
        times["records"] = {
            {"bytes_written", run.records.bytes_written}, {"waiting_bytes_read", run.records.bytes_read},
            {"waiting_parts", run.records.waiting_parts}, {"bytes_read", run.record_bytes_read},
            {"cached_share", run.record_cached_share},    {"sample_iterations", run.sample_iterations},
            {"working_set_bytes", run.working_set_bytes},
        };
    return times;
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
void warn_about_range(const Dataset& dataset, const FitRequest& request) {
    const auto space = family_of(request).streamed(request);
    if (!space) return;
    const bool encoded = space == TargetSpace::stored && dataset.encoding == Encoding::u8_srgb;
    constexpr double uneven = 256;  // 8 bits are left
    const View *brightest = nullptr, *darkest = nullptr;
    double largest = 0, smallest = 0;
    for (const View& view : dataset.views) {
        const double light = double(view.peak) * view.gain.most(), value = encoded ? srgb_encode(light) : light;
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
void save(const std::string& folder, FinishedFit& done, const FitRequest& request, const Record& begun) {
    FitRecord& fit = done.fit->record();
    auto times = describe_run(fit, done.run, request, begun);
    if (!done.times_json.empty()) times.update(nlohmann::ordered_json::parse(done.times_json));
    fit.times_json = times.dump();
    done.fit->write(folder, [&](const std::filesystem::path& inside) {
        write_file(inside / "trace.csv", trace_csv(done.run.trace, request.label(), fit.engine));
        done.fit->write_error_bars(inside);
    });
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

/// Says what the fit needs, and stops where that is not there.
void announce_plan(const std::string& out, const Dataset& dataset, const FitRequest& request, bool force) {
    constexpr size_t views_to_count_samples_on = 8;
    const Plan planned = plan(dataset, request, views_to_count_samples_on);
    announce_needs("fit", {total_bytes(planned.memory) + program_bytes, total_bytes(planned.disk)}, out, force);
}

/// What a fit's record begins with.
Record begin_record(const Dataset& dataset, const Invocation& invocation) {
    Record begun = make_record(invocation.argc, invocation.argv);
    begun.datasets->push_back(dataset_note(dataset));
    return begun;
}

/// Checks what a fit came to, writes it and says so.
void leave(const std::string& out, const Dataset& dataset, const FitRequest& request, FinishedFit done,
           const Record& begun, bool covariance = false) {
    const FitRecord& record = done.fit->record();
    require_result(record, dataset);
    if (covariance) done.fit->find_error_bars({});
    save(out, done, request, begun);
    const auto counts = record.status_counts();
    log_info(fmt::format("{} {}{}{} problems without samples, {} not finite; see {}", request.text("model"),
                         summary_of(done.run, request, record), done.note, counts[size_t(Status::no_samples)],
                         counts[size_t(Status::not_finite)], out));
}

/// A fit of all training images, unless judged by it some of them are outliers: then one of the others.
FinishedFit fit_without_outliers(const Dataset& dataset, FitRequest& request) {
    std::vector<std::string> outliers;
    {
        FinishedFit all = family_of(request).fit(dataset, request);
        const Dataset fitted = for_validation(dataset, request.validation);
        outliers = outlying_images(judge(all.fit->contestant(), fitted, Split::train));
        if (outliers.empty()) {
            log_info("no training image stands out");
            return all;
        }
    }
    request.leave_out = fmt::format("{}", fmt::join(outliers, ","));
    log_info(fmt::format("left out, since a fit misses them by far more than the others: {}", request.leave_out));
    return family_of(request).fit(dataset, request);
}

/// In one piece; or in parts, on one machine or on all that mpirun chose, which OUT.parts keeps until all are there.
void fit(const std::string& out, const Dataset& dataset, FitRequest request, const Invocation& invocation, bool force,
         bool leave_out_outliers, bool covariance) {
    const Record begun = begin_record(dataset, invocation);
    const std::filesystem::path parts = std::filesystem::path(out).concat(".parts");
    if (const std::unique_ptr<Ranks> ranks = join_ranks()) {
        auto done = fit_on_ranks(*ranks, dataset, request, parts, force);
        if (!done) return;
        leave(out, dataset, request, std::move(*done), begun, covariance);
    } else if (!needs_parts(dataset, request)) {
        announce_plan(out, dataset, request, force);
        FinishedFit done =
            leave_out_outliers ? fit_without_outliers(dataset, request) : family_of(request).fit(dataset, request);
        return leave(out, dataset, request, std::move(done), begun, covariance);
    } else {
        fit_shard(dataset, request, {}, parts, force);
        leave(out, dataset, request, merge_shards(dataset, request, {parts}), begun, covariance);
    }
    std::error_code ignored;
    std::filesystem::remove_all(parts, ignored);
}

/// What --leave-out-outliers asks of a fit. Throws UserError.
void require_one_piece(const Dataset& dataset, const FitRequest& request, bool shard) {
    if (!request.leave_out.empty())
        throw UserError("--leave-out-outliers finds images itself; leave out it or --leave-out");
    if (shard || needs_parts(dataset, request) || join_ranks())
        throw UserError(
            "--leave-out-outliers fits in one piece; fit a lower --surface-side so, then name the images that it "
            "leaves out by --leave-out");
}

/// What --covariance asks of a fit. Throws UserError.
void require_error_bars(const FitRequest& request, bool shard) {
    if (!family_of(request).has_error_bars)
        throw UserError(
            fmt::format("--covariance: {} have no error bars; choose lfm or a texel-local model, such as lafortune",
                        family_of(request).name));
    if (shard) throw UserError("--covariance is of a whole fit; leave out it or --shard");
}

}  // namespace

void add_fit(CommandLine& program, const Invocation& invocation) {
    auto request = std::make_shared<FitRequest>();
    auto folder = std::make_shared<std::string>();
    auto out = std::make_shared<std::string>();
    auto shard = std::make_shared<std::string>();
    auto force = std::make_shared<bool>(false);
    auto leave_out_outliers = std::make_shared<bool>(false);
    CommandLine& command = program.add_command("fit", "fit a model to a packed dataset");
    command.add_text("dataset", *folder, "packed dataset").required();
    add_fit_options(command, *request);
    command.add_text("-o,--output", *out, "folder of the fit, or of the shard").required();
    command.add_text("--shard", *shard,
                     "2/7: only the second of seven shares of the surface, into a folder for radiafit merge");
    add_force(command, *force);
    command.add_flag("--leave-out-outliers", *leave_out_outliers,
                     "fit twice: all training images, and those that the first fit does not miss by far");
    auto covariance = std::make_shared<bool>(false);
    command.add_flag("--covariance", *covariance,
                     "maps of the parameters' standard deviations as well, of lfm and texel-local models");
    command.on_run([=, &command] {
        const std::optional<Shard> share = shard->empty() ? std::nullopt : std::optional(parse_shard(*shard));
        if (!share) {
            check_fit_target(*out);
            // an output that cannot be written shows now, not at the end
            const AtomicFolder tried(*out, AtomicFolder::Existing::replace);
        }
        check_apart(*out, request->records);
        request->scratch = (std::filesystem::absolute(*out) / "").parent_path().parent_path();
        const Dataset dataset = open_dataset(*folder);
        const auto given = [&](const char* option) { return command.given(option); };
        const std::string chosen =
            settle(given, share || given("--memory") || started_together() > 1, dataset, *request);
        reject_idle_options(*request, dataset.has_grid());
        if (*leave_out_outliers) require_one_piece(dataset, *request, share.has_value());
        if (*covariance) require_error_bars(*request, share.has_value());
        if (!chosen.empty()) log_info(chosen);
        warn_about_range(dataset, *request);
        if (share)
            fit_shard(dataset, *request, *share, *out, *force);
        else
            fit(*out, dataset, *request, invocation, *force, *leave_out_outliers, *covariance);
    });
}

void add_merge(CommandLine& program, const Invocation& invocation) {
    auto folders = std::make_shared<std::vector<std::string>>();
    auto moved_to = std::make_shared<std::string>();
    auto out = std::make_shared<std::string>();
    CommandLine& command = program.add_command("merge", "put the shards of a fit together");
    command.add_rest("shards", *folders, "folders that radiafit fit --shard wrote, all of one fit").required();
    command.add_text("--dataset", *moved_to, "where the dataset is now, if it moved");
    command.add_text("-o,--output", *out, "folder of the fit").required();
    command.on_run([=] {
        check_fit_target(*out);
        { const AtomicFolder tried(*out, AtomicFolder::Existing::replace); }
        const ShardNote note = read_shard(folders->front());
        const Dataset dataset = open_dataset(moved_to->empty() ? note.dataset : std::filesystem::path(*moved_to));
        const Record begun = begin_record(dataset, invocation);
        leave(*out, dataset, note.request, merge_shards(dataset, note.request, {folders->begin(), folders->end()}),
              begun);
    });
}

}  // namespace radiafit
