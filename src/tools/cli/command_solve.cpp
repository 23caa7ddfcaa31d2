// solve: many small least-squares problems from arrays.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/choose.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/interrupt.h"
#include "base/journal.h"
#include "base/log.h"
#include "base/resources.h"
#include "batch/problem_files.h"
#include "cli/commands.h"
#include "cli/solution_folder.h"
#include "dataset/checksums.h"
#include "fitting/fit_key.h"
#include "fitting/limits.h"
#include "fitting/solvers/solve.h"
#include "fitting/unfinished.h"

namespace radiafit::tools {
namespace {

using batch::BatchStatus;
using Json = nlohmann::ordered_json;

struct SolveCommand {
    std::string input, model, out, shard;
    std::vector<std::string> start, lower, upper, fix;
    batch::Precision precision = batch::Precision::double_precision;
    batch::Options options;
    int iterations = batch::default_iterations(batch::Options().optimizer);
    double checkpoint_s = FitRequest().checkpoint_s;
    uint64_t memory = 256 << 20;  ///< bytes of problems and solutions at a time
    bool json = false, resume = false, force = false;
};

constexpr double huge = std::numeric_limits<double>::max();
constexpr Range<int> iteration_range{0, 1'000'000};
constexpr Range<double> tolerance_range{0, 1, "0 is by the precision"};
constexpr Range<double> scale_range{1e-30, 1e30};
constexpr Range<double> rate_range{1e-12, 1e3};

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

/// All that decides a solution, as JSON, which all shards of one have in common.
Json solve_key(const SolveCommand& command, const batch::ModelText& model,
               const std::vector<std::filesystem::path>& files) {
    std::string problems;
    for (const std::filesystem::path& file : files)
        problems += fmt::format("{} {:016x} ", file.filename().string(), file_checksum(file));
    const batch::Options& o = command.options;
    const auto joined = [](const std::vector<std::string>& texts) { return fmt::format("{}", fmt::join(texts, ",")); };
    return Json{{"program", program_key()},
                {"problems", problems},
                {"options",
                 {{"start", joined(command.start)},
                  {"lower", joined(command.lower)},
                  {"upper", joined(command.upper)},
                  {"fix", joined(command.fix)},
                  {"precision", name_of_choice(batch::precisions(), command.precision)},
                  {"optimizer", name_of_choice(batch::batch_optimizers(), o.optimizer)},
                  {"learning-rate", o.learning_rate},
                  {"iterations", *o.iterations},
                  {"tolerance", o.tolerance},
                  {"loss", name_of_choice(batch::batch_losses(), o.loss)},
                  {"loss-scale", o.loss_scale},
                  {"known-noise", o.known_noise}}},
                {"model_text", fmt::format("{:016x}", hash_bytes(model.text.data(), model.text.size()))}};
}

/// The same and which problems stand in which block, as what an interrupted run left carries it.
std::string key_of_run(Json key, const SolveCommand& command) {
    key["options"]["shard"] = command.shard;
    key["options"]["memory"] = bytes_text(command.memory);
    return key.dump();
}

/// Problems that are in memory at a time.
struct Block {
    size_t first, count;
};

/// Those of a range, of so many bytes each at most, but of one problem at least.
template <class Bytes>
std::vector<Block> blocks_of(Block range, uint64_t most, const Bytes& bytes) {
    std::vector<Block> out;
    for (size_t first = range.first, end = range.first + range.count; first < end;) {
        size_t fits = 1, beyond = end - first + 1;
        while (beyond - fits > 1) {
            const size_t middle = fits + (beyond - fits) / 2;
            (bytes(first, middle) <= most ? fits : beyond) = middle;
        }
        out.push_back({first, fits});
        first += fits;
    }
    return out;
}

Block share_of(const std::optional<Shard>& shard, size_t problems) {
    if (!shard) return {0, problems};
    const size_t i = size_t(shard->index), n = size_t(shard->count);
    if (n > problems)
        throw UserError(fmt::format("--shard {}/{}: there are {} problems; choose fewer shards", i, n, problems));
    const size_t first = problems * (i - 1) / n;
    return {first, problems * i / n - first};
}

/// Block by block; `unfinished` keeps what is solved.
template <class real>
void solve_blocks(const SolveCommand& command, const Record& record, const std::filesystem::path& unfinished) {
    const batch::ModelText text = batch::read_model_file(command.model);
    batch::Options options = command.options;
    options.lower = batch::of_parameters(text, "lower", by_name("lower", command.lower), -INFINITY);
    options.upper = batch::of_parameters(text, "upper", by_name("upper", command.upper), INFINITY);
    options.fixed = batch::among_parameters(text, "fix", parts_of(command.fix));
    const batch::ProblemFiles<real> files(command.input, text, by_name("start", command.start));
    SolutionNote note{.model = text, .precision = command.precision, .labelled = !files.labels().empty()};
    if (!command.shard.empty()) note.shard = parse_shard(command.shard);
    const Block range = share_of(note.shard, files.count());
    note.problems = range.count;
    const Json key = solve_key(command, text, files.files());
    const std::string run = key_of_run(key, command);
    note.key = key.dump();
    batch::check_options(text, options);
    check_unfinished(unfinished, run, command.resume);

    const auto bytes = [&](size_t first, size_t count) {
        return files.bytes(first, count) + count * solution_bytes(note);
    };
    const uint64_t kept = command.checkpoint_s > 0 ? 2 : 1, disk = kept * range.count * solution_bytes(note);
    const uint64_t all = bytes(range.first, range.count), one = all / std::max<size_t>(1, range.count);  // on average
    const uint64_t block = std::max(one, std::min(command.memory, all));
    announce_needs("solve", {files.held_bytes() + block + program_bytes, disk}, command.out, command.force);
    const std::vector<Block> blocks = blocks_of(range, command.memory, bytes);
    SolutionFolder<real> folder(command.out, note);
    if (blocks.size() > 1)  // what is wrong in the last one shows now, not at the end
        for (const Block& b : blocks) batch::check_problems(text, files.read(b.first, b.count).arrays(), options);
    const batch::CompiledModel model(text, command.precision);
    if (model.seconds() > 0)
        log_info(fmt::format("{}: compiled in {:.1f} s, and kept", command.model, model.seconds()));

    Journal journal(unfinished / (std::string("solution") + journal_extension), run, command.checkpoint_s);
    Progress progress("solve", range.count);
    options.journal = &journal;
    options.progress = &progress;
    note.statuses.assign(size_t(BatchStatus::count), 0);
    for (const Block& b : blocks) {
        const batch::StoredProblems<real> problems = files.read(b.first, b.count);
        const Stopwatch clock;
        const batch::Solution<real> solution = batch::solve(model, problems.arrays(), options);
        note.seconds += clock.wall_s();
        const std::vector<size_t> counts = solution.counts();
        for (size_t s = 0; s < counts.size(); ++s) note.statuses[s] += counts[s];
        folder.add(solution, problems.labels);
    }
    progress.finish();
    folder.commit(note, record);
    remove_unfinished(unfinished);
    print_solution(note, command.json);
}

template <class real>
void solve_files(const SolveCommand& command, const Invocation& invocation) {
    const std::filesystem::path unfinished = unfinished_folder(command.out);
    try {
        solve_blocks<real>(command, make_record(invocation.argc, invocation.argv), unfinished);
    } catch (Interrupted& stop) {
        stop.note = what_is_unfinished(unfinished);
        throw;
    }
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
    command.writes([=] { return std::vector{OutputTarget{.path = o->out}}; },
                   [=] {
                       remove_leftovers_of(o->out);
                       print_done(o->out, o->json);
                   });
    command.add_words("--start", o->start, "where fits begin: NAME=VALUE, between commas");
    command.add_words("--lower", o->lower, "lowest values: NAME=VALUE, between commas");
    command.add_words("--upper", o->upper, "highest values: NAME=VALUE, between commas");
    command.add_words("--fix", o->fix, "parameters that stay as they start: NAME, between commas");
    command.add_choice("--precision", o->precision, batch::precisions(),
                       "of all numbers: double or float; default: double");
    command.add_choice(
        "--optimizer", o->options.optimizer, batch::batch_optimizers(),
        "lm: Levenberg and Marquardt's method; cg, lbfgs, adam: by gradients, in more steps; default: lm");
    command.add_number("--learning-rate", o->options.learning_rate, rate_range,
                       "of adam: its first step, where 1 changes a model's values by as much as they miss the targets");
    command.add_number(
        "--iterations", o->iterations, iteration_range,
        fmt::format("steps at most; {} where it is not lm", batch::default_iterations(batch::BatchOptimizer::adam)));
    command.add_number("--tolerance", o->options.tolerance, tolerance_range,
                       "a fit ends where its next step is so many standard deviations");
    command.add_choice("--loss", o->options.loss, batch::batch_losses(),
                       "square, huber or cauchy: what a residual costs; default: square");
    command.add_number("--loss-scale", o->options.loss_scale, scale_range,
                       "residuals, times the roots of their weights, well below it cost their square");
    command.add_flag(
        "--known-noise", o->options.known_noise,
        "weights are 1 / variance; otherwise relative to it, and the variance is found from the residuals");
    command
        .add("--memory", "BYTES", bytes_text(o->memory),
             "that problems and what is found of them take at a time, such as 64M",
             [=](const std::string& text) { o->memory = parse_bytes("memory", text); })
        .idle();
    command.add_text("--shard", o->shard,
                     "2/7: only the second of seven shares of the problems, into a folder for radiafit merge");
    command
        .add_flag("--resume", o->resume,
                  "go on from what a run that was stopped left in OUTPUT.parts, and refuse it if it is of another")
        .idle();
    command
        .add_number("--checkpoint", o->checkpoint_s, limits::checkpoint,
                    "seconds after which what is solved goes to OUTPUT.parts again")
        .idle();
    add_force(command, o->force);
    add_json(command, o->json);
    command.on_run([=, &command, &invocation] {
        const bool given = command.given("--iterations");
        o->options.iterations = given ? o->iterations : batch::default_iterations(o->options.optimizer);
        if (command.given("--learning-rate") && o->options.optimizer != batch::BatchOptimizer::adam)
            throw UserError("--learning-rate is of --optimizer adam; leave out one of them");
        if (o->precision == batch::Precision::double_precision)
            solve_files<double>(*o, invocation);
        else
            solve_files<float>(*o, invocation);
    });
}

}  // namespace radiafit::tools
