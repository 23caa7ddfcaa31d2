// tune: which model and options suit a dataset.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/interrupt.h"
#include "base/log.h"
#include "base/standard_streams.h"
#include "cli/commands.h"
#include "fitting/image_checks.h"
#include "fitting/tune.h"

namespace radiafit::tools {
namespace {

void print_json(const std::string& dataset, const std::vector<TriedSetting>& all) {
    auto rows = nlohmann::ordered_json::array();
    for (const TriedSetting& t : all)
        rows.push_back(
            {{"options", command_line_of(t.setting)}, {"psnr", t.psnr}, {"ape", t.ape}, {"seconds", t.seconds}});
    fmt::print("{}\n", nlohmann::ordered_json{{"dataset", dataset}, {"tried", rows}}.dump(2));
}

void print_table(const std::string& dataset, const std::vector<TriedSetting>& all, int validation) {
    fmt::print("PSNR, dB    APE   seconds  options, best first; one in {} training views was left out to judge by\n",
               validation);
    for (const TriedSetting& t : all)
        fmt::print("{:8.2f} {:6.2f} {:9.1f}  {}\n", t.psnr, t.ape, t.seconds, command_line_of(t.setting));
    // A name of its own: DATASET-fit is what the README calls the default fit.
    const std::string stem = dataset.substr(0, dataset.find_last_not_of('/') + 1);
    fmt::print("\nradiafit fit {} {} -o {}-tuned\n", dataset, command_line_of(all.front().setting), stem);
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
        const auto all = tune(
            dataset, o->tune,
            [](const TriedSetting& t) {
                log_info(fmt::format("{:.2f} dB in {:.1f} s: {}", t.psnr, t.seconds, command_line_of(t.setting)));
            },
            &stopped);
        if (stopped && all.empty()) throw Interrupted(*stopped);
        if (o->json)
            print_json(o->dataset, all);
        else {
            const std::string suspicious = stopped ? "" : describe_suspicious(suspicious_images(dataset));
            if (!suspicious.empty()) log_warning(suspicious);
            print_table(o->dataset, all, left_out_every(dataset, o->tune));
        }
        if (!stopped) return;
        finish_standard_output();
        stopped->note = fmt::format("the best of {} that were tried are printed", all.size());
        throw Interrupted(*stopped);
    });
}

}  // namespace radiafit::tools
