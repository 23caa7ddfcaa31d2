#include "experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/failure.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/read_file.h"
#include "base/standard_streams.h"
#include "base/time_limit.h"
#include "base/wording.h"
#include "command_line/command_line.h"
#include "dataset/checksums.h"
#include "fitting/limits.h"
#include "fragment/half_rounding.h"
#include "gl/context.h"
#include "report/csv_file.h"
#include "report/half_rows.h"
#include "show_rows.h"

namespace radiafit::harness {

namespace fs = std::filesystem;

namespace {

bool is_checkout(const fs::path& folder) {
    return folder_exists(folder / "experiments") && folder_exists(folder / "paper_figs");
}

/// The checkout that the config file lies in, or else the working folder.
fs::path find_checkout(const fs::path& config) {
    for (fs::path folder = fs::absolute(config).parent_path(); folder != folder.root_path();
         folder = folder.parent_path())
        if (is_checkout(folder)) return folder;
    for (fs::path folder = fs::current_path();; folder = folder.parent_path()) {
        if (is_checkout(folder)) return folder;
        if (folder == folder.root_path()) break;
    }
    throw UserError(
        fmt::format("{}: neither this file nor the working folder lies in a checkout, which has experiments/ "
                    "and paper_figs/; run it in one",
                    config.string()));
}

}  // namespace

Experiment::Experiment(std::string name, int argc, const char* const* argv, RunOption run_option)
    : name_(std::move(name)) {
    CommandLine program(name_, "Runs one experiment and draws its figure.");
    std::string config = "experiments/" + name_ + ".toml", output, run;
    std::vector<std::string> overrides;
    int threads = 0;
    double minutes = 0;
    program.add_text("--config", config, "any file; the checkout's own gives the standard run");
    program.add_word("--profile", profile_, "smoke, standard or paper");
    program.add_words("--set", overrides, "key=value, over the config file");
    program.add_text("--output", output, "folder for rows and figures, in place of the checkout's").hide_default();
    program.add_flag("--resume", resume_, "do nothing if this revision's run of the profile is there");
    program.add_number("--threads", threads, limits::threads, "0 is all cores");
    program.add_number("--minutes", minutes, Range<double>{0, 1e5},
                       "end rounds in time to be done in so many; 0: all of them");
    program
        .add_text("--run", run,
                  run_option == RunOption::figure
                      ? "only draw the figure of this earlier run, here or in the output folder"
                      : "of the runs in this folder, or in an archive that radiafit-bench --all wrote")
        .hide_default();
    if (!program.parse(argc, argv)) {
        finish_standard_output();
        std::exit(0);
    }
    set_thread_count(threads);
    if (minutes > 0) limit_time(minutes);
    root_ = find_checkout(config);
    output_ = output;
    if (run_option == RunOption::figure) run_ = run;
    if (run_option == RunOption::results && !run.empty()) {
        unpacked_ = std::make_unique<UnpackedResults>(run);
        overrides.push_back("results=" + json_string(fs::absolute(unpacked_->folder()).string()));
    }
    standard_ = overrides.empty() && output.empty() &&
                fs::weakly_canonical(config) == fs::weakly_canonical(root_ / "experiments" / (name_ + ".toml"));
    if (!run_.empty()) return;
    config_ = std::make_unique<Config>(config, profile_, overrides);
    record_ = make_record(argc, argv);
    lock_ = std::make_unique<OutputLock>(results() / name_);
    AtomicFolder(results() / name_ / "probe");  // a folder that can't be written shows before any work
}

fs::path Experiment::figures() const {
    if (!output_.empty()) return output_;
    return profile_ == "standard" ? root_ / "paper_figs" : root_ / "paper_figs" / profile_;
}

Dataset Experiment::dataset(const std::string& shape, const OrnamentOptions& ornament, const std::string& variant,
                            uint64_t seed) const {
    SyntheticOptions options{.shape = shape, .scale = profile_, .seed = seed, .ornament = ornament};
    synthetic_size(options);  // an unknown name shows before any work
    std::string name = fmt::format("{}-{}{}{}", shape, profile_, variant.empty() ? "" : "-", variant);
    if (seed != SyntheticOptions().seed) name += fmt::format("-seed{}", seed);
    const fs::path folder = root_ / "datasets" / "packed" / name;
    if (fs::exists(folder)) {
        Dataset dataset = open_dataset(folder);
        if (dataset.source == synthetic_source(options)) return noted(std::move(dataset));
    }
    log_info(fmt::format("generating {} at {} scale", shape, profile_));
    generate_synthetic(options, folder);
    return open(folder);
}

Dataset Experiment::open(const fs::path& folder) const { return noted(open_dataset(folder)); }

Dataset Experiment::noted(Dataset dataset) const {
    const std::string note = dataset_note(dataset);
    if (std::ranges::find(*record_.datasets, note) == record_.datasets->end()) record_.datasets->push_back(note);
    return dataset;
}

ResultFolder Experiment::open_results(const std::string& device) const {
    Record record = record_;
    record.config = config_->resolved();
    record.more.emplace_back("profile", json_string(profile_));
    record.more.emplace_back("standard", standard_ ? "true" : "false");
    // The seed of all other random numbers is in the experiment's config, under "seed".
    record.more.emplace_back(
        "seeds", fmt::format(R"({{"datasets": {}, "start": {}}})", SyntheticOptions().seed, FitRequest().seed));
    // a software renderer's times are those of the processor
    return ResultFolder(results(), name_, is_software_renderer(device) ? device + ", " + record_.cpu : device, record);
}

void Experiment::finish(ResultFolder& results, const std::string& caption) const {
    const std::string dated = fmt::format(
        "{}{}; {}", caption, rounds_left_out() ? "; cut short, as time was limited" : "", utc_now().substr(0, 10));
    if (rounds_left_out()) results.record().more.emplace_back("rounds_left_out", "true");
    results.record().more.emplace_back("caption", json_string(dated));
    std::vector<fs::path> shown;
    if (standard_ || !output_.empty()) {
        results.commit();
        shown = show_rows(root_, name_, results.path(), dated, figures());
    } else {
        shown = show_rows(root_, name_, results.path(), dated, results.path());
        const fs::path hidden = results.path();
        results.commit();
        for (fs::path& file : shown) file = results.path() / file.lexically_relative(hidden);
    }
    for (const fs::path& file : shown) log_info("figure: " + file.string());
    log_info("rows: " + results.path().string());
}

void Experiment::redraw(const fs::path& folder) const {
    const RunRecord run = read_run(folder);
    if (run.experiment != name_)
        throw UserError(fmt::format("{}: a run of {}, not of {}", folder.string(), run.experiment, name_));
    for (const fs::path& file : show_run(root_, run, output_.empty() ? fs::current_path() : output_))
        log_info("figure: " + file.string());
}

bool Experiment::finished_before() const {
    if (record_.git_revision.ends_with("-dirty")) return false;  // which may be any program
    for (const RunRecord& run : newest_runs(results(), name_, profile_))
        if (run.revision == record_.git_revision && run.cpu == record_.cpu && run.threads == record_.threads &&
            !run.rounds_left_out) {
            log_info(fmt::format("{} is there: {}", name_, run.folder.string()));
            return true;
        }
    return false;
}

bool Experiment::done() {
    if (!run_.empty()) {
        redraw(run_);
        return true;
    }
    return resume_ && standard_ && finished_before();
}

std::string Experiment::cpu_name() const { return fmt::format("cpu, {} threads", thread_count()); }
std::string Experiment::cpu_device() const {
    return fmt::format("{}, {} thread{}", record_.cpu, thread_count(), thread_count() == 1 ? "" : "s");
}

void read_option(Config& config, FitRequest& request, const std::string& name) {
    std::string text = request.text(name);
    config.read(name, text, valid_option(name));
    request.set(name, text);
}

std::function<void(const std::string&)> valid_option(const std::string& name) {
    return [name](const std::string& text) { FitRequest().set(name, text); };
}

void note_gl(const FitRun& outcome, Record& record) {
    if (outcome.gl_renderer.empty()) return;
    record.gl_vendor = outcome.gl_vendor;
    record.gl_renderer = outcome.gl_renderer;
    record.gl_version = outcome.gl_version;
}

void note_gl(const Context& context, Record& record) {
    record.gl_vendor = context.vendor();
    record.gl_renderer = context.renderer();
    record.gl_version = context.version();
}

void write_halves(const ResultFolder& results, const ContextOptions& options) {
    const auto context = Context::create(options);
    CsvFile rows(results.path(), rows_of::halves);
    for (const HalfRounding& h : measure_half_rounding()) rows.add({h.of, h.values, h.subnormals});
    rows.commit();
}

FitOutcome solve_noting_errors(const Dataset& dataset, const FitRequest& request, const SharedSamples& samples,
                               std::vector<std::vector<float>>& errors, Record& record) {
    Progress progress(fmt::format("{} {}", dataset.name, request.label()), size_t(request.iterations) + 1);
    FitOutcome fit = solve(dataset, request, &samples, [&](int, const auto& read_errors) {
        errors.emplace_back(3 * dataset.mesh.vertex_count());
        read_errors(errors.back());
        progress.advance();
    });
    note_gl(fit, record);
    return fit;
}

void read_maps(Config& config, LfmOptions& model) {
    double lambda = 1e-3;
    config.read("surface_side", model.surface_side, limits::map_side);
    config.read("view_side", model.view_side, limits::map_side);
    config.read("lambda", lambda, limits::weight);
    model.lambda_surface = model.lambda_view = float(lambda);
}

void check_shape(const std::string& shape) { synthetic_size({.shape = shape}); }

void check_light_field_shape(const std::string& shape) {
    check_shape(shape);
    if (shape == "ornament")
        throw UserError("ornament has a lamp that moves, which no light field map follows; choose star or bust");
}

double log_slope(const Points& points) {
    double x = 0, y = 0, xx = 0, xy = 0;
    const double n = double(points.size());
    for (const auto& [a, b] : points) {
        const double u = std::log(a), v = std::log(b);
        x += u, y += v, xx += u * u, xy += u * v;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

std::vector<uint32_t> spread_views(const std::vector<uint32_t>& views, int count) {
    if (count == 0 || size_t(count) >= views.size()) return views;
    std::vector<uint32_t> some;
    for (int i = 0; i < count; ++i) some.push_back(views[size_t(i) * views.size() / size_t(count)]);
    return some;
}

int run_experiment(const std::string& name, int argc, const char* const* argv,
                   const std::function<void(Experiment&)>& body, RunOption run_option) {
    end_idle_blas_threads();
    name_options_by_flag();
    prepare_standard_streams();
    catch_interrupts();
    try {
        Experiment experiment(name, argc, argv, run_option);
        if (!experiment.done()) body(experiment);
        return 0;
    } catch (const Interrupted& interrupted) {
        end_interrupted(name, interrupted);
    } catch (const std::exception& e) {
        const Failure failure = describe(e);
        log_error(name, failure.line);
        return failure.status;
    }
}

}  // namespace radiafit::harness
