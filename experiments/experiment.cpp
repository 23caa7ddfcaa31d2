#include "experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/command_line.h"
#include "app/limits.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/failure.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/read_file.h"
#include "base/standard_streams.h"
#include "base/wording.h"
#include "dataset/checksums.h"
#include "gl/context.h"
#include "report/figures.h"

namespace radiafit {

Experiment::Experiment(std::string name, int argc, const char* const* argv) : name_(std::move(name)) {
    CommandLine program(name_, "Runs one experiment and draws its figure.");
    std::string config;
    std::vector<std::string> overrides;
    int threads = 0;
    program.add_text("--config", config, "experiments/" + name_ + ".toml").required();
    program.add_word("--profile", profile_, "smoke, standard or paper");
    program.add_words("--set", overrides, "key=value, over the config file");
    program.add_number("--threads", threads, limits::threads, "0 is all cores");
    if (!program.parse(argc, argv)) {
        finish_standard_output();
        std::exit(0);
    }
    set_thread_count(threads);
    root_ = std::filesystem::absolute(config).parent_path().parent_path();
    config_ = std::make_unique<Config>(config, profile_, overrides);
    record_ = make_record(argc, argv);
    AtomicFolder(root_ / "results" / name_ / "probe");  // a folder that can't be written shows before any work
}

void Experiment::require_figures() const {
    if (!folder_stands(figures()))
        throw UserError(
            fmt::format("{}: no such folder, so no figure can be drawn; give a config file in a checkout's "
                        "experiments/",
                        figures().string()));
}

Dataset Experiment::dataset(const std::string& shape, const OrnamentOptions& ornament, const std::string& variant,
                            uint64_t seed) const {
    SyntheticOptions options{.shape = shape, .scale = profile_, .seed = seed, .ornament = ornament};
    require_figures();
    synthetic_size(options);  // an unknown name shows before any work
    std::string name = fmt::format("{}-{}{}{}", shape, profile_, variant.empty() ? "" : "-", variant);
    if (seed != SyntheticOptions().seed) name += fmt::format("-seed{}", seed);
    const std::filesystem::path folder = root_ / "datasets" / "packed" / name;
    if (std::filesystem::exists(folder)) {
        Dataset dataset = open_dataset(folder);
        if (dataset.source == synthetic_source(options)) return noted(std::move(dataset));
    }
    log_info(fmt::format("generating {} at {} scale", shape, profile_));
    generate_synthetic(options, folder);
    return open(folder);
}

Dataset Experiment::open(const std::filesystem::path& folder) const { return noted(open_dataset(folder)); }

Dataset Experiment::noted(Dataset dataset) const {
    const std::string note = dataset_note(dataset);
    if (std::ranges::find(*record_.datasets, note) == record_.datasets->end()) record_.datasets->push_back(note);
    return dataset;
}

ResultFolder Experiment::open_results(const std::string& device) const {
    require_figures();
    Record record = record_;
    record.config = config_->resolved();
    record.more.emplace_back("profile", json_string(profile_));
    // What is drawn besides, an experiment's config has under "seed".
    record.more.emplace_back(
        "seeds", fmt::format(R"({{"datasets": {}, "start": {}}})", SyntheticOptions().seed, FitRequest().seed));
    return ResultFolder(root_ / "results", name_, device, record);
}

void Experiment::draw(const ResultFolder& results, const std::string& caption) const {
    const std::filesystem::path stem = figures() / name_;
    draw_figure(
        figures() / (name_ + ".gp"), stem,
        {{"rows", results.path().string()}, {"caption", fmt::format("{}; {}", caption, utc_now().substr(0, 10))}});
    log_info(fmt::format("figure: {0}.svg and .png; rows: {1}", stem.string(), results.path().string()));
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
                   const std::function<void(Experiment&)>& body) {
    name_options_by_flag();
    prepare_standard_streams();
    try {
        Experiment experiment(name, argc, argv);
        body(experiment);
        return 0;
    } catch (const std::exception& e) {
        const Failure failure = describe(e);
        log_error(name, failure.line);
        return failure.status;
    }
}

}  // namespace radiafit
