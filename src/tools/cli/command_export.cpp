// export: what is fitted, and what a fit found, for other people's solvers.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/log.h"
#include "cli/commands.h"
#include "dataset/checksums.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"

namespace radiafit::tools {
namespace {

std::string options_json(const FitRequest& request) {
    auto json = nlohmann::ordered_json::object();
    for (const FitOption& o : fit_options())
        if (o.states_problem) json[o.name] = nlohmann::json::parse(o.json(request));
    return json.dump();
}

void add_problems(CommandLine& exporter, const Invocation& invocation) {
    auto request = std::make_shared<FitRequest>();
    auto folder = std::make_shared<std::string>();
    auto out = std::make_shared<std::string>();
    CommandLine& command = exporter.add_command("problems", "the problems of a fit, as arrays that numpy reads");
    command.add_text("dataset", *folder, "packed dataset").required().input();
    for (const FitOption& o : fit_options())
        if (o.states_problem) add_fit_option(command, *request, o.name);
    command.add_text("-o,--output", *out, "folder of the problems").required().idle();
    command.writes([=] { return std::vector{OutputTarget{.path = *out}}; });
    command.on_run([=, &command] {
        request->check();
        ProblemFolder problems(*out, "radiafit-problems");
        Record record = make_record(invocation.argc, invocation.argv);
        const Dataset dataset = open_dataset(*folder);
        record.datasets->push_back(dataset_note(dataset));
        // A problem has neither: they are for who solves it to choose.
        const auto given = [&](const std::string& option) {
            return option == "--optimizer" || option == "--prior" || command.given(option);
        };
        family_of(*request).resolve_options(given, dataset, *request);
        reject_idle_options(*request, dataset.has_grid());
        problems.describe_dataset(dataset.name, fingerprint(dataset));
        family_of(*request).export_problems(dataset, *request, problems);
        problems.tell("options", options_json(*request));
        problems.commit(record);
        log_info(fmt::format("problems of {}: {}", request->text("model"), *out));
    });
}

void add_parameters(CommandLine& exporter, const Invocation& invocation) {
    auto folder = std::make_shared<std::string>();
    auto moved_to = std::make_shared<std::string>();
    auto out = std::make_shared<std::string>();
    CommandLine& command = exporter.add_command("parameters", "a fit's parameters, in the same layout");
    command.add_text("fit", *folder, "folder of the fit").required().input();
    command.add_text("--dataset", *moved_to, "where the dataset is now, if it moved").idle();
    command.add_text("-o,--output", *out, "folder of the parameters").required().idle();
    command.writes([=] { return std::vector{OutputTarget{.path = *out}}; });
    command.on_run([=] {
        ProblemFolder parameters(*out, "radiafit-parameters");
        const Record record = make_record(invocation.argc, invocation.argv);
        auto fit = open_fit(*folder, *moved_to);
        parameters.describe_dataset(fit.record().dataset_name, fit.record().dataset_fingerprint);
        export_parameters(fit, parameters);
        parameters.commit(record);
        log_info(fmt::format("parameters of {}: {}", *folder, *out));
    });
}

}  // namespace

void add_export(CommandLine& program, const Invocation& invocation) {
    CommandLine& command =
        program.add_command("export", "write a fit for other programs, problems for other people's solvers");
    add_problems(command, invocation);
    add_parameters(command, invocation);
    add_export_files(command);
}

}  // namespace radiafit::tools
