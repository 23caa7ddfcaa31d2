// solve: many small least-squares problems from arrays.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "batch/problem_files.h"
#include "cli/commands.h"
#include "fitting/problem_folder.h"
#include "report/csv.h"

namespace radiafit::tools {
namespace {

using batch::BatchStatus;

struct SolveCommand {
    std::string input, model, out;
    std::vector<std::string> start, lower, upper, fix;
    batch::Precision precision = batch::Precision::double_precision;
    batch::Options options;
    bool json = false;
};

constexpr double huge = std::numeric_limits<double>::max();
constexpr Range<int> iteration_range{0, 1'000'000};
constexpr Range<double> tolerance_range{0, 1, "0 is by the precision"};
constexpr Range<double> scale_range{1e-30, 1e30};

/// What stands between the commas of texts.
std::vector<std::string> parts_of(const std::vector<std::string>& texts) {
    std::vector<std::string> out;
    for (const std::string& text : texts) {
        std::istringstream parts(text);
        for (std::string part; std::getline(parts, part, ',');) out.push_back(part);
    }
    return out;
}

/// "a=1,b=2" of each text, as values by name.
batch::ByName by_name(const std::string& option, const std::vector<std::string>& texts) {
    batch::ByName out;
    for (const std::string& part : parts_of(texts)) {
        const size_t equals = part.find('=');
        if (equals == std::string::npos)
            throw UserError(fmt::format("{} = '{}': write NAME=VALUE, between commas", option, part));
        const std::string name = part.substr(0, equals);
        out[name] = parse_number(option + " " + name, part.substr(equals + 1), Range<double>{-huge, huge});
    }
    return out;
}

template <class real>
void write_table(const std::filesystem::path& file, const batch::ModelText& model,
                 const batch::StoredProblems<real>& problems, const batch::Solution<real>& solution) {
    std::vector<std::string> header = {"problem"};
    for (const std::string& name : model.parameters) header.insert(header.end(), {name, "sigma_" + name});
    header.insert(header.end(), {"error", "samples", "iterations", "status"});
    CsvWriter table(file, header);
    const size_t parameters = model.parameters.size();
    for (size_t i = 0; i < problems.count; ++i) {
        std::vector<std::string> row = {problems.labels[i]};
        for (size_t k = i * parameters; k < (i + 1) * parameters; ++k)
            for (const real x : {solution.parameters[k], solution.deviations[k]}) row.push_back(fmt::format("{}", x));
        row.insert(row.end(), {fmt::format("{}", solution.error[i]), std::to_string(solution.samples[i]),
                               std::to_string(solution.steps[i]), batch::name_of(BatchStatus(solution.status[i]))});
        table.row(row);
    }
    table.commit();
}

nlohmann::ordered_json status_json(const std::vector<size_t>& counts) {
    auto json = nlohmann::ordered_json::object();
    for (size_t s = 0; s < counts.size(); ++s) json[batch::name_of(BatchStatus(s))] = counts[s];
    return json;
}

template <class real>
void solve_files(const SolveCommand& command, const Invocation& invocation) {
    ProblemFolder folder(command.out, "radiafit-solution");
    const Record record = make_record(invocation.argc, invocation.argv);
    const batch::ModelText text = batch::read_model_file(command.model);
    batch::Options options = command.options;
    options.lower = batch::of_parameters(text, "lower", by_name("lower", command.lower), -INFINITY);
    options.upper = batch::of_parameters(text, "upper", by_name("upper", command.upper), INFINITY);
    options.fixed = batch::among_parameters(text, "fix", parts_of(command.fix));
    const auto problems = batch::read_problems<real>(command.input, text, by_name("start", command.start));
    const batch::CompiledModel model(text, command.precision);
    if (model.seconds() > 0)
        log_info(fmt::format("{}: compiled in {:.1f} s, and kept", command.model, model.seconds()));
    const Stopwatch clock;
    const batch::Solution<real> solution = batch::solve(model, problems.arrays(), options);
    const double seconds = clock.wall_s();

    const uint64_t n = problems.count, p = text.parameters.size();
    folder.write<real>("parameters", {n, p}, solution.parameters,
                       "of the best end of each problem, as `parameters` names them");
    folder.write<real>("sigma", {n, p}, solution.deviations,
                       "standard deviations; 0: fixed, or at a bound; infinite: not determined");
    folder.write<real>("covariance", {n, p, p}, solution.covariance, "of the parameters");
    folder.write<real>("chi2", {n}, solution.error, "sum of weight times squared residual, or of the loss");
    folder.write<int32_t>("status", {n}, solution.status, "how each ended, as `statuses` names them from 0 on");
    folder.write<int32_t>("iterations", {n}, solution.steps, "steps tried, of the best start");
    folder.write<int64_t>("samples", {n}, solution.samples, "that are not missing");
    if (!problems.labels.empty()) write_table(folder.path() / "solution.csv", text, problems, solution);
    const auto json = [](const auto& value) {
        using Json = nlohmann::ordered_json;  // a model's comments may be in another encoding than UTF-8
        return Json(value).dump(-1, ' ', false, Json::error_handler_t::replace);
    };
    const std::vector<size_t> counts = solution.counts();
    folder.tell("model", json(text.text));
    folder.tell("parameters", json(text.parameters));
    folder.tell("terms", json(text.terms));
    folder.tell("values", json(text.values));
    folder.tell("statuses", status_json(counts).dump());
    folder.tell("seconds", json(seconds));
    folder.commit(record);

    if (command.json) {
        fmt::print(
            "{}\n",
            nlohmann::ordered_json{{"problems", n}, {"seconds", seconds}, {"statuses", status_json(counts)}}.dump());
        return;
    }
    fmt::print("{} problems in {:.3g} s: {:.3g} a second\n", n, seconds, double(n) / seconds);
    for (size_t s = 0; s < counts.size(); ++s)
        if (counts[s] > 0)
            fmt::print("  {} {}: {}\n", counts[s], batch::name_of(BatchStatus(s)), batch::meaning_of(BatchStatus(s)));
}

}  // namespace

void add_solve(CommandLine& program, const Invocation& invocation) {
    auto o = std::make_shared<SolveCommand>();
    CommandLine& command = program.add_command(
        "solve", "fit a model of one's own to many small sets of samples, from arrays (docs/solve.md)");
    command.add_text("problems", o->input, "folder of arrays (terms.npy, targets.npy, ...), or a table (CSV)")
        .required()
        .input();
    command.add_text("--model", o->model, "text of the model").required().input();
    command.add_text("-o,--output", o->out, "folder of the solution").required().idle();
    command.writes([=] { return std::vector{OutputTarget{.path = o->out}}; }, [=] { print_done(o->out, o->json); });
    command.add_words("--start", o->start, "where fits begin: NAME=VALUE, between commas");
    command.add_words("--lower", o->lower, "lowest values: NAME=VALUE, between commas");
    command.add_words("--upper", o->upper, "highest values: NAME=VALUE, between commas");
    command.add_words("--fix", o->fix, "parameters that stay as they start: NAME, between commas");
    command.add_choice("--precision", o->precision, batch::precisions(),
                       "of all numbers: double or float; default: double");
    command.add_number("--iterations", o->options.iterations, iteration_range, "steps at most");
    command.add_number("--tolerance", o->options.tolerance, tolerance_range,
                       "a fit ends where its next step is so many standard deviations");
    command.add_choice("--loss", o->options.loss, batch::batch_losses(),
                       "square, huber or cauchy: what a residual costs; default: square");
    command.add_number("--loss-scale", o->options.loss_scale, scale_range,
                       "residuals, times the roots of their weights, well below it cost their square");
    command.add_flag(
        "--known-noise", o->options.known_noise,
        "weights are 1 / variance; otherwise relative to it, and the variance is found from the residuals");
    add_json(command, o->json);
    command.on_run([=, &invocation] {
        if (o->precision == batch::Precision::double_precision)
            solve_files<double>(*o, invocation);
        else
            solve_files<float>(*o, invocation);
    });
}

}  // namespace radiafit::tools
