// tune: which model and options suit a dataset.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/interrupt.h"
#include "base/log.h"
#include "base/standard_streams.h"
#include "cli/commands.h"
#include "fitting/image_checks.h"
#include "fitting/tune.h"
#include "publish/publish.h"

namespace radiafit::tools {
namespace {

const TriedSetting& recommended(const Tuned& tuned) { return tuned.tried[tuned.recommended]; }

/// About how long the page of a fit takes.
double page_seconds(const TriedSetting& t, const Dataset& dataset) {
    const double view = t.judge_seconds / double(std::max<size_t>(t.errors.size(), 1));
    return expected_seconds(t.numbers, view, std::max<size_t>(dataset.split(true).size(), 1));
}

void print_json(const std::string& name, const Dataset& dataset, const Tuned& tuned) {
    auto rows = nlohmann::ordered_json::array(), left_out = rows;
    for (const TriedSetting& t : tuned.tried)
        rows.push_back({{"options", command_line_of(t.setting)},
                        {"psnr", t.psnr},
                        {"ape", t.ape},
                        {"off_photographs_psnr", t.off_psnr ? nlohmann::ordered_json(*t.off_psnr) : nullptr},
                        {"seconds", t.seconds},
                        {"judge_seconds", t.judge_seconds},
                        {"page_seconds", page_seconds(t, dataset)},
                        {"numbers", t.numbers},
                        {"bytes", t.bytes()}});
    for (const UntriedSetting& s : tuned.left_out)
        left_out.push_back({{"options", command_line_of(s.setting)}, {"seconds", s.seconds}});
    fmt::print("{}\n", nlohmann::ordered_json{{"dataset", name},
                                              {"tried", rows},
                                              {"recommended", command_line_of(recommended(tuned).setting)},
                                              {"left_out", left_out},
                                              {"models_left_out", tuned.models_left_out},
                                              {"off_photographs_left_out", tuned.off_left_out.has_value()}}
                           .dump(2));
}

/// What was left out, and what more seconds would try.
std::string describe_left_out(const Tuned& tuned, double given_seconds) {
    if (tuned.left_out.empty())
        return "all settings next to the best one were tried: more seconds would try nothing else";
    double seconds = given_seconds;
    std::vector<std::string> each;
    for (const UntriedSetting& s : tuned.left_out) {
        seconds += s.seconds;
        const std::string about = s.seconds > 0 ? fmt::format(" (about {})", duration(s.seconds)) : "";
        each.push_back(command_line_of(s.setting) + about);
    }
    return fmt::format("left out for want of time: {}; --seconds {:.0f} would try {}", fmt::join(each, ", "),
                       10 * std::ceil(seconds / 10), each.size() == 1 ? "it" : "them");
}

void print_table(const std::string& name, const Dataset& dataset, const Tuned& tuned, const TuneOptions& options) {
    fmt::print(
        "PSNR, dB  off, dB    APE  numbers, M      MB  fit, s  judge, s  page, s  options, best first; one in {} "
        "training views was left out to judge by; off: {} degrees from the nearest view of a fit without those around "
        "some\n",
        left_out_every(dataset, options), off_photographs_degrees);
    for (const TriedSetting& t : tuned.tried)
        fmt::print("{:8.2f} {:>8} {:6.2f} {:11.3f} {:7.1f} {:7.1f} {:9.1f} {:8.0f}  {}\n", t.psnr,
                   t.off_psnr ? fmt::format("{:.2f}", *t.off_psnr) : "", t.ape, double(t.numbers) / 1e6,
                   double(t.bytes()) / 1e6, t.seconds, t.judge_seconds, page_seconds(t, dataset),
                   command_line_of(t.setting));
    fmt::print("\n");
    const TriedSetting &best = tuned.tried.front(), &chosen = recommended(tuned);
    if (best.setting.front() != chosen.setting.front() && best.off_psnr)
        fmt::print("{}: {:.2f} dB less than the best amid the photographs, and better than it off them\n",
                   command_line_of(chosen.setting), best.psnr - chosen.psnr);
    else if (tuned.recommended > 0)
        fmt::print(
            "{}: {:.2f} dB less than the best, with {:.2g} of its numbers: within the noise of {} views, or less than "
            "0.05 dB for twice the numbers\n",
            command_line_of(chosen.setting), best.psnr - chosen.psnr, double(chosen.numbers) / double(best.numbers),
            best.errors.size());
    if (!tuned.models_left_out.empty())
        fmt::print("models that do not take all options given: {}\n", fmt::join(tuned.models_left_out, ", "));
    fmt::print("{}\n", describe_left_out(tuned, options.seconds));
    if (tuned.off_left_out)
        fmt::print("models were not compared off the photographs, which would take about {}\n",
                   duration(*tuned.off_left_out));
    fmt::print("\n");
    // A name of its own: DATASET-fit is what the README calls the default fit.
    const std::string stem = name.substr(0, name.find_last_not_of('/') + 1);
    fmt::print("radiafit fit {} {} -o {}-tuned\n", name, command_line_of(chosen.setting), stem);
}

/// Options of a fit that tune takes, too: every fit then has them. Fits of tune are in one piece and
/// not kept; what they leave out to judge by, tune decides.
bool may_be_fixed(const FitOption& option) {
    return option.name != "validation" && option.name != "memory" && option.name != "records";
}

}  // namespace

void add_tune(CommandLine& program) {
    struct Options {
        std::string dataset;
        TuneOptions tune;
        FitRequest fixed;
        bool json = false;
    };
    auto o = std::make_shared<Options>();
    CommandLine& command =
        program.add_command("tune",
                            "which model and options suit a dataset, on training views that are left out; options "
                            "of fit that are given stay as they are");
    command.add_text("dataset", o->dataset, "packed dataset").required();
    command.add_number("--seconds", o->tune.seconds, limits::tune_seconds, "about how long it may take");
    command.add_number("--validation", o->tune.validation, limits::tune_validation,
                       "every n-th training view is left out, to judge by");
    add_json(command, o->json);
    for (const FitOption& option : fit_options())
        if (may_be_fixed(option)) add_fit_option(command, o->fixed, option.name);
    command.on_run([=, &command] {
        for (const FitOption& option : fit_options())
            if (may_be_fixed(option) && command.given(option.first_flag()))
                o->tune.fixed.emplace_back(option.name, option.text(o->fixed));
        const Dataset dataset = open_dataset(o->dataset);
        std::optional<Interrupted> stopped;
        const Tuned tuned = tune(
            dataset, o->tune,
            [](const TriedSetting& t) {
                log_info(fmt::format("{:.2f} dB in {:.1f} s: {}", t.psnr, t.seconds, command_line_of(t.setting)));
            },
            &stopped);
        if (stopped && tuned.tried.empty()) throw Interrupted(*stopped);
        if (o->json)
            print_json(o->dataset, dataset, tuned);
        else {
            const std::string suspicious = stopped ? "" : describe_suspicious(suspicious_images(dataset));
            if (!suspicious.empty()) log_warning(suspicious);
            print_table(o->dataset, dataset, tuned, o->tune);
        }
        if (!stopped) return;
        finish_standard_output();
        stopped->note = fmt::format("the best of {} that were tried are printed", tuned.tried.size());
        throw Interrupted(*stopped);
    });
}

}  // namespace radiafit::tools
