// fit: its options, what it runs, what it leaves.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "base/journal.h"
#include "base/log.h"
#include "base/read_file.h"
#include "base/record.h"
#include "base/resources.h"
#include "cli/commands.h"
#include "cli/solution_folder.h"
#include "dataset/checksums.h"
#include "eval/outliers.h"
#include "fitting/family.h"
#include "fitting/fit_key.h"
#include "fitting/fit_options.h"
#include "fitting/leave_fit.h"
#include "fitting/limits.h"
#include "fitting/parts/fit_on_ranks.h"
#include "fitting/parts/parts.h"
#include "fitting/parts/ranks.h"
#include "fitting/resolve_options.h"
#include "fitting/unfinished.h"

namespace radiafit::tools {

void add_fit_option(CommandLine& c, FitRequest& r, const std::string& name) {
    const FitOption& o = find_fit_option(name);
    const std::string help = o.type == "NAME" ? o.values + ": " + o.help : o.help;
    CommandOption added = o.flag_value ? c.add_flag(o.flag, r.*o.flag_value, help)
                                       : c.add(o.flag, o.type, o.hide_default ? "" : o.text(r), help,
                                               [&r, &o](const std::string& text) { o.read(r, text); });
    if (!o.flag_value) added.choices(o.choices);
    if (!o.decides_result) added.idle();
    if (o.names_input) added.input();
    added.group(o.group);
}

void add_fit_options(CommandLine& c, FitRequest& r) {
    for (const FitOption& o : fit_options()) add_fit_option(c, r, o.name);
}

namespace {

/// What a command is given in addition to the request's options.
struct FitCommand : FitTarget {
    std::string dataset, shard;
    bool force = false, leave_out_outliers = false, resume = false;
};

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
                        "bits up to the largest value, so that one keeps less than 8; correct pixels or gains",
                        dataset.folder.string(), brightest->name, largest, darkest->name, smallest));
}

/// Says what the fit needs, and stops where that is not there.
void announce_plan(const std::string& out, const Dataset& dataset, const FitRequest& request, bool force) {
    const Plan planned = plan(dataset, request, views_to_count_samples_on);
    announce_needs("fit", {total_bytes(planned.memory) + program_bytes, total_bytes(planned.disk)}, out, force);
}

/// A fit of all training images, unless judged by it some of them are outliers: then one of the others.
FinishedFit fit_without_outliers(const Dataset& dataset, FitRequest& request) {
    std::vector<std::string> outliers;
    {
        FinishedFit all = family_of(request).fit(dataset, request);
        const Dataset fitted = for_validation(dataset, request.validation);
        outliers = outlying_images(judge(contestant_of(all.fit), fitted, Split::train));
        if (outliers.empty()) {
            log_info("no training image stands out");
            return all;
        }
    }
    request.leave_out = fmt::format("{}", fmt::join(outliers, ","));
    log_info(fmt::format("left out, since a fit misses them by far more than the others: {}", request.leave_out));
    return family_of(request).fit(dataset, request);
}

/// On one machine, in one piece or in parts; `parts` keeps what is finished.
void fit_alone(const FitCommand& command, const Dataset& dataset, FitRequest request, const Record& begun,
               const std::filesystem::path& parts) {
    const std::string key = fit_key(dataset, request);
    check_unfinished(parts, key, command.resume);
    if (needs_parts(dataset, request)) {
        fit_shard(dataset, request, {}, parts, command.force);
        return leave(command, dataset, request, merge_shards(dataset, request, {parts}), begun);
    }
    announce_plan(command.out, dataset, request, command.force);
    request.journal =
        std::make_shared<Journal>(parts / ("whole" + std::string(journal_extension)), key, request.checkpoint_s);
    FinishedFit done =
        command.leave_out_outliers ? fit_without_outliers(dataset, request) : family_of(request).fit(dataset, request);
    leave(command, dataset, request, std::move(done), begun);
}

/// Alone, or on all machines that mpirun chose. OUT.parts keeps what is finished until the fit is there.
void fit(const FitCommand& command, const Dataset& dataset, const FitRequest& request, const Invocation& invocation) {
    const Record begun = begin_record(dataset, invocation.argc, invocation.argv);
    const std::filesystem::path parts = unfinished_folder(command.out);
    if (const std::unique_ptr<Ranks> ranks = join_ranks()) {
        if (!begin_together(*ranks)) return;
        auto done = fit_on_ranks(*ranks, dataset, request, parts, command.force);
        if (!done) return;
        leave(command, dataset, request, std::move(*done), begun);
    } else {
        try {
            fit_alone(command, dataset, request, begun, parts);
        } catch (Interrupted& stop) {
            stop.note = what_is_unfinished(parts);
            throw;
        }
    }
    remove_unfinished(parts);
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

OutputTarget fit_target(const std::filesystem::path& folder) {
    return {.path = folder, .check = [folder] { check_fit_target(folder); }};
}

void add_fit(CommandLine& program, const Invocation& invocation) {
    auto request = std::make_shared<FitRequest>();
    auto o = std::make_shared<FitCommand>();
    CommandLine& command = program.add_command("fit", "fit a model to a packed dataset");
    command.add_text("dataset", o->dataset, "packed dataset").required().input();
    add_fit_options(command, *request);
    command.add_text("-o,--output", o->out, "folder of the fit, or of the shard").required().idle();
    command.add_text("--shard", o->shard,
                     "2/7: only the second of seven shares of the surface, into a folder for radiafit merge");
    command
        .add_flag("--resume", o->resume,
                  "go on from what a fit that was stopped left in OUTPUT.parts, and refuse it if it is of another")
        .idle();
    command
        .add_number("--checkpoint", request->checkpoint_s, limits::checkpoint,
                    "seconds after which what is finished goes to OUTPUT.parts again")
        .idle();
    add_force(command, o->force);
    command.add_flag("--leave-out-outliers", o->leave_out_outliers,
                     "fit twice: all training images, and those that the first fit does not miss by far");
    command.add_flag("--covariance", o->covariance,
                     "maps of the parameters' standard deviations as well, of lfm and texel-local models");
    add_json(command, o->json);
    command.writes(
        [=, &command] {
            if (started_as() > 0) return std::vector<OutputTarget>();  // rank 0 looks for all
            OutputTarget target = fit_target(o->out);
            target.lock = started_together() == 1;  // ranks lock what they have in common
            target.resumed = !o->shard.empty();
            if (target.resumed && command.given("--replace"))
                throw UserError(
                    "--replace is of whole fits, and a shard goes on from what is there: remove its folder, or choose "
                    "another");
            return std::vector{target};
        },
        [o] {
            if (const std::unique_ptr<Ranks> ranks = join_ranks()) begin_together(*ranks, false);
            remove_leftovers_of(o->out);
            print_done(o->out, o->json);
        });
    command.on_run([=, &command] {
        const std::optional<Shard> share = o->shard.empty() ? std::nullopt : std::optional(parse_shard(o->shard));
        // an output that cannot be written shows now, not at the end
        if (!share) {
            const AtomicFolder tried(o->out, AtomicFolder::Existing::replace);
        }
        check_apart(o->out, request->records);
        request->scratch = (std::filesystem::absolute(o->out) / "").parent_path().parent_path();
        const Dataset dataset = open_dataset(o->dataset);
        const auto given = [&](const char* option) { return command.given(option); };
        const std::string chosen = resolve_options(given, dataset, *request);
        reject_idle_options(*request, dataset.has_grid());
        if (o->leave_out_outliers) require_one_piece(dataset, *request, share.has_value());
        if (o->covariance) require_error_bars(*request, share.has_value());
        if (!chosen.empty()) log_info(chosen);
        o->check = !chosen.empty();
        warn_about_range(dataset, *request);
        if (share)
            fit_shard(dataset, *request, *share, o->out, o->force);
        else
            fit(*o, dataset, *request, invocation);
    });
}

void add_merge(CommandLine& program, const Invocation& invocation) {
    auto folders = std::make_shared<std::vector<std::string>>();
    auto moved_to = std::make_shared<std::string>();
    auto o = std::make_shared<FitCommand>();
    CommandLine& command = program.add_command("merge", "put the shards of a fit, or of a solution, together");
    command.add_rest("shards", *folders, "folders that radiafit fit --shard or solve --shard wrote, all of one")
        .required()
        .input();
    command.add_text("--dataset", *moved_to, "where the dataset is now, if it moved").idle();
    command.add_text("-o,--output", o->out, "folder of the whole").required().idle();
    add_json(command, o->json);
    const auto of_solution = [=] { return path_exists(std::filesystem::path(folders->front()) / solution_json_name); };
    command.writes([=] { return std::vector{of_solution() ? OutputTarget{.path = o->out} : fit_target(o->out)}; },
                   [o] { print_done(o->out, o->json); });
    command.on_run([=, &command] {
        { const AtomicFolder tried(o->out, AtomicFolder::Existing::replace); }
        if (of_solution()) {
            if (command.given("--dataset")) throw UserError("--dataset is of shards of a fit; leave it out");
            const Record record = make_record(invocation.argc, invocation.argv);
            return print_solution(merge_solutions({folders->begin(), folders->end()}, o->out, record), o->json);
        }
        const ShardNote note = read_shard(folders->front());
        const Dataset dataset = open_dataset(moved_to->empty() ? note.dataset : std::filesystem::path(*moved_to));
        const Record begun = begin_record(dataset, invocation.argc, invocation.argv);
        leave(*o, dataset, note.request, merge_shards(dataset, note.request, {folders->begin(), folders->end()}),
              begun);
    });
}

}  // namespace radiafit::tools
