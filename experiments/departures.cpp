// What our corrections of the paper's text are worth, each left out by itself (numbered in docs/paper.md): how far the
// paper's optimizers then come, on light field maps of the star and on Lafortune's model on the ornament.
#include "rows/departures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/atomic_file.h"
#include "base/log.h"
#include "base/statistics.h"
#include "cpu/texel_solvers_of.h"
#include "dataset/truth.h"
#include "eval/judge.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "fragment/fragment_engine.h"
#include "gl/context.h"
#include "model/lfm_start.h"
#include "model/texel_model_of.h"
#include "model/texel_texts.h"
#include "report/csv_file.h"
#include "report/table.h"
#include "samples/texel_loader.h"

#define RADIAFIT_TEXEL_MODEL lafortune_raw_n
#define RADIAFIT_TEXEL_FILE "lafortune_raw_n.glsl"
#include "model/define_texel_text.h"

namespace radiafit::texel_text {

/// Fits begin at one shape, a mirror's direction with n = 10, not at the best of 15.
template <class real_type>
struct lafortune_one_start : lafortune<real_type> {
    template <class other>
    using with = lafortune_one_start<other>;
    static constexpr const char* name = "lafortune_one_start";
    static constexpr int start_count = 1;
    static constexpr double starts[start_count][3] = {{-1, 1, 2.302585093}};
};

}  // namespace radiafit::texel_text

namespace radiafit::harness {
namespace {

namespace rows = rows_of::departures;

constexpr const char* fitted_model = "lafortune";

struct Options {
    std::string dataset = "star", reflectance = "ornament";
    LfmOptions model;
    int cg_iterations = 100, sd_iterations = 500, best_iterations = 2000, half_iterations = 20, half_images = 40;
    int culling_images = 8, reflectance_cg_iterations = 100, reflectance_sd_iterations = 250;
    double tolerance = 1.01, within = 1.05;

    explicit Options(Config& c) {
        c.read("dataset", dataset, check_light_field_shape);
        read_maps(c, model);
        c.read("cg_iterations", cg_iterations, limits::some_iterations);
        c.read("sd_iterations", sd_iterations, limits::some_iterations);
        c.read("best_iterations", best_iterations, limits::some_iterations);
        c.read("tolerance", tolerance, limits::tolerance);
        c.read("half_iterations", half_iterations, limits::some_iterations);
        c.read("half_images", half_images, limits::images);
        c.read("culling_images", culling_images, limits::images);
        c.read("reflectance", reflectance, check_shape);
        c.read("reflectance_cg_iterations", reflectance_cg_iterations, limits::some_iterations);
        c.read("reflectance_sd_iterations", reflectance_sd_iterations, limits::some_iterations);
        c.read("within", within, limits::tolerance);
        c.finish();
        if (reflectance != "ornament") c.reject("reflectance", "only the ornament has lights and a truth");
    }
};

/// A correction by its number in docs/paper.md, and how a fit goes without it.
struct Departure {
    std::string id, without;
    std::function<void(FitRequest&)> leave_out;
    /// Departures of one objective compare by E_t; others minimize another one.
    std::string objective = "";
};

Departure step(const std::string& id, const std::string& without, int left_out) {
    return {id, without, [=](FitRequest& r) { r.left_out = left_out; }};
}

const Departure none = {"", "all mends", [](FitRequest&) {}};
const Departure plain_sum = {"M5", "E a plain sum, the same lambda",
                             [](FitRequest& r) { r.model.corrections.normalized = false; }, "sum"};

/// density: mean of S-bar.
Departure plain_sum_and_weight(double density) {
    return {"M5", "E a plain sum, lambda times its mean growth",
            [=](FitRequest& r) {
                r.model.corrections.normalized = false;
                r.model.lambda_surface *= float(density);
                r.model.lambda_view *= float(density);
            },
            "weighted sum"};
}

std::vector<Departure> of_conjugate_gradients(double density) {
    return {none,
            step("M1", "Eq. 7 as printed", WITHOUT_SIGN),
            step("M2", "no Gauss-Newton curvature where d'Hd <= 0", WITHOUT_GAUSS_NEWTON),
            step("M3", "beta of Eq. 8 where d climbs", WITHOUT_DOWNHILL),
            {"M4", "no penalties in d'Hd", [](FitRequest& r) { r.model.corrections.penalty_curvature = false; }},
            plain_sum,
            plain_sum_and_weight(density),
            {"M6", "one lambda for both kinds of maps",
             [](FitRequest& r) { r.model.corrections.scaled_lambda_view = false; }, "one lambda"},
            step("S1", "a problem ends when its error rises", WITHOUT_RETRY),
            {"S4", "mu = 1", [](FitRequest& r) { r.mu = 1; }, "mu"}};
}

Departure first_step(float size) {
    return {"M7", fmt::format("first step {:g}", size), [=](FitRequest& r) {
                r.left_out = WITHOUT_MEASURED_STEP;
                r.first_step = size;
            }};
}

std::vector<Departure> of_steepest_descent() {
    return {none,
            first_step(0.1f),
            first_step(1),
            first_step(10),
            step("S1", "a problem ends when its error rises", WITHOUT_RETRY),
            plain_sum};
}

/// A row of fits.csv.
struct Row {
    std::string problem, renderer, optimizer, numbers;
    Departure departure;
    int iterations = 0;
    size_t problems = 0;
    double arrived = NAN, iterations_median = NAN;  ///< share within the tolerance; those that don't count as never
    double stalled = 0, not_finite = 0;             ///< shares
    double error = 0;                               ///< sum of E over samples, without penalties
    double error_ratio = 1;                         ///< over that with all corrections
    double psnr = NAN, ape = NAN, held_psnr = NAN;
};

/// One fit of the star on the CPU, with every problem's error after every iteration.
struct Traced {
    Row row;
    std::vector<std::vector<float>> errors;
    std::vector<Status> status;
};

class Departures {
public:
    explicit Departures(Experiment& experiment) : experiment_(experiment), o_(experiment.config()) {}
    void run();

private:
    FitRequest request(const char* optimizer, int iterations) const {
        FitRequest r;
        r.set("optimizer", optimizer);
        r.set("mode", "paper");
        r.model = o_.model;
        r.iterations = iterations;
        return r;
    }
    Row row_of(const FitOutcome& out, const FitRequest& r, const Departure& departure,
               const std::string& numbers) const;
    void light_field_maps();
    void half_precision();
    void culling();
    void reflectance();
    void say(const Row& row) const {
        log_info(fmt::format("{}, {}, {}: {} {}: error {:.4f} of that with all mends", row.problem, row.optimizer,
                             row.numbers, row.departure.id, row.departure.without, row.error_ratio));
    }
    void write();

    Experiment& experiment_;
    Options o_;
    Dataset dataset_;
    double density_ = 1;
    std::vector<Row> rows_;
    std::vector<rows::Culling> culling_;
};

double sum(const std::vector<float>& values) {
    double total = 0;
    for (const float x : values) total += double(x);
    return total;
}

Row Departures::row_of(const FitOutcome& out, const FitRequest& r, const Departure& departure,
                       const std::string& numbers) const {
    Row row{.problem = "light field map",
            .renderer = out.gl_renderer.empty() ? experiment_.cpu_name() : out.gl_renderer,
            .optimizer = r.text("optimizer"),
            .numbers = numbers,
            .departure = departure,
            .iterations = r.iterations};
    const auto counts = out.fit.status_counts();
    row.problems = out.fit.problem_count() - counts[size_t(Status::no_samples)];
    row.not_finite = double(counts[size_t(Status::not_finite)]) / double(row.problems);
    row.stalled = double(counts[size_t(Status::stationary)]) / double(row.problems);
    row.error = sum(out.fit.error);
    const Contestant contestant = contestant_of(out.fit, dataset_.mesh);
    const JudgeResult train = judge(contestant, dataset_, Split::train, at_pixel_centres);
    row.psnr = train.psnr();
    row.ape = train.ape();
    row.held_psnr = judge(contestant, dataset_, Split::test, at_pixel_centres).psnr();
    return row;
}

void Departures::light_field_maps() {
    const TriangleAtlas atlas(dataset_.mesh, o_.model.surface_side);
    const SharedSamples samples = distribute(dataset_, atlas, request("cg", 0));
    density_ = double(samples.statistics.samples) / double(samples.statistics.texels);
    std::vector<Traced> fits;
    std::map<std::string, std::vector<float>> best;  // by objective: the least error of each problem
    const auto solve_one = [&](const Departure& departure, const char* optimizer, int iterations) {
        FitRequest r = request(optimizer, iterations);
        departure.leave_out(r);
        Traced out;
        const FitOutcome fit = solve_noting_errors(dataset_, r, samples, out.errors, experiment_.record());
        out.row = row_of(fit, r, departure, "fp32");
        out.status = fit.fit.status;
        std::vector<float>& least = best[departure.objective];
        if (least.empty()) least = out.errors.back();
        for (size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], out.errors.back()[i]);
        return out;
    };
    std::vector<Departure> objectives;
    for (const auto& [optimizer, iterations, list] :
         {std::tuple("cg", o_.cg_iterations, of_conjugate_gradients(density_)),
          std::tuple("sd", o_.sd_iterations, of_steepest_descent())}) {
        const size_t first = fits.size();
        for (const Departure& departure : list) {
            if (!best.contains(departure.objective)) solve_one(departure, "cg", o_.best_iterations);
            fits.push_back(solve_one(departure, optimizer, iterations));
            fits.back().row.error_ratio = fits.back().row.error / fits[first].row.error;
            say(fits.back().row);
        }
    }
    for (Traced& fit : fits) {
        const std::vector<float>& least = best.at(fit.row.departure.objective);
        size_t arrived = 0, stalled = 0;
        std::vector<double> iterations;
        for (size_t i = 0; i < fit.status.size(); ++i) {
            if (fit.status[i] == Status::no_samples) continue;
            const double level = o_.tolerance * double(least[i]);
            const auto found = std::partition_point(fit.errors.begin(), fit.errors.end(),
                                                    [&](const auto& errors) { return !(double(errors[i]) <= level); });
            const bool there = found != fit.errors.end();
            arrived += there;
            stalled += !there && fit.status[i] == Status::stationary;
            iterations.push_back(there ? double(found - fit.errors.begin()) : fit.row.iterations + 1);
        }
        fit.row.arrived = double(arrived) / double(fit.row.problems);
        fit.row.stalled = double(stalled) / double(fit.row.problems);
        fit.row.iterations_median = median(std::move(iterations));
        rows_.push_back(fit.row);
    }
}

void Departures::half_precision() {
    const std::vector<uint32_t> views = spread_views(dataset_.split(false), o_.half_images);
    for (const char* sums : {"fp32", "fp16"}) {
        const size_t first = rows_.size();
        for (const Departure& departure : {none, plain_sum, plain_sum_and_weight(density_)}) {
            FitRequest r = request("cg", o_.half_iterations);
            r.set("engine", "fragment");
            r.set("storage", "fp16");
            r.set("sums", sums);
            departure.leave_out(r);
            const FitOutcome out = solve(dataset_, r, nullptr, {}, &views);
            note_gl(out, experiment_.record());
            rows_.push_back(row_of(out, r, departure, fmt::format("fp16, sums {}", sums)));
            rows_.back().error_ratio = rows_.back().error / rows_[first].error;
            say(rows_.back());
        }
    }
}

void Departures::culling() {
    const std::vector<uint32_t> views = spread_views(dataset_.split(false), o_.culling_images);
    const FitRequest r = request("cg", 1);
    const auto context = Context::create(r.context);
    note_gl(*context, experiment_.record());
    const TriangleAtlas atlas(dataset_.mesh, o_.model.surface_side);
    const VertexRings rings(dataset_.mesh);
    std::vector<float> parameters[2];
    std::array<double, 4> amounts[2];
    for (const bool cull : {true, false}) {
        FragmentOptions fragment = r.fragment_options();
        fragment.passes = Passes::paper;
        fragment.cull = cull;
        FragmentEngine engine(dataset_, atlas, rings, views, r.model_options(), fragment);
        engine.reset(lfm_start(engine.layout(), engine.count().mean, r.seed));
        engine.passes().tally(true);
        optimize(engine, r.optimizer_options());
        engine.passes().tally(false);
        double fragments = 0;
        Work work;
        for (const auto& [label, tally] : engine.passes().tallies()) {
            fragments += double(tally.fragments);
            work += tally.work();
        }
        parameters[cull].resize(engine.layout().size());
        engine.read_parameters(parameters[cull]);
        amounts[cull] = {fragments, double(work.operations), double(work.reads), double(work.read_bytes)};
    }
    const bool same = parameters[0] == parameters[1];
    for (const bool cull : {true, false})
        culling_.push_back({cull ? "" : "H7", cull ? "culled on the CPU" : "all triangles", context->renderer(),
                            views.size(), amounts[cull][0], amounts[cull][1], amounts[cull][2],
                            amounts[cull][1] / amounts[1][1], amounts[cull][2] / amounts[1][2], same});
}

/// Lafortune's model by a separate text, with the solvers made from that, over the same samples.
struct Variant {
    Departure departure;
    const TexelModel* model;
    const TexelSolvers* solvers;
};

void Departures::reflectance() {
    const Dataset dataset = experiment_.dataset(o_.reflectance);
    const ReflectanceTruth truth = read_truth(dataset.folder);
    const TexelModelOf<texel_text::lafortune_raw_n<float>> raw_n;
    const TexelSolversOf<texel_text::lafortune_raw_n<Pack>> raw_n_solvers;
    const TexelModelOf<texel_text::lafortune_one_start<float>> one_start;
    const TexelSolversOf<texel_text::lafortune_one_start<Pack>> one_start_solvers;
    const TexelModel& model = *find_texel_model(fitted_model);
    const TexelSolvers& solvers = texel_solvers(model);

    FitRequest general = request("cg", 0);
    general.set("model", fitted_model);
    general.set("mode", "paper");
    general.model.surface_side = dataset.normal_map.side;
    const std::vector<uint32_t> views = dataset.split(false);
    const SharedTexels shared = distribute_texels(dataset, general, views);
    const std::unique_ptr<Atlas> atlas = texel_atlas(dataset, general.model.surface_side);

    const auto problem_of = [&](const TexelModel& of, TexelOptions& options, const FitRequest& r) {
        options = r.texel_options();
        options.model = &of;
    };
    TexelOptions options;
    problem_of(model, options, general);
    const TexelLoader loader(dataset, *atlas, views, options);
    const TexelResult best = solvers.solve_lm({*shared.source, loader, options}, {.iterations = 50}, {});

    const std::vector<Variant> variants = {
        {none, &model, &solvers},
        {step("M1", "Eq. 7 as printed", WITHOUT_SIGN), &model, &solvers},
        {step("M2", "no Gauss-Newton curvature where d'Hd <= 0", WITHOUT_GAUSS_NEWTON), &model, &solvers},
        {step("M3", "beta of Eq. 8 where d climbs", WITHOUT_DOWNHILL), &model, &solvers},
        {step("S1", "a problem ends when its error rises", WITHOUT_RETRY), &model, &solvers},
        {{"M8", "n in place of log n", [](FitRequest&) {}}, &raw_n, &raw_n_solvers},
        {{"M9", "one start", [](FitRequest&) {}}, &one_start, &one_start_solvers}};
    for (const auto& [optimizer, iterations] :
         {std::pair("cg", o_.reflectance_cg_iterations), std::pair("sd", o_.reflectance_sd_iterations)}) {
        const size_t first = rows_.size();
        for (const Variant& variant : variants) {
            FitRequest r = general;
            r.set("optimizer", optimizer);
            r.iterations = iterations;
            variant.departure.leave_out(r);
            TexelOptions here;
            problem_of(*variant.model, here, r);
            const TexelResult result =
                variant.solvers->stream({*shared.source, loader, here}, r.optimizer_options(), {});
            Row row{.problem = "Lafortune",
                    .renderer = experiment_.cpu_name(),
                    .optimizer = optimizer,
                    .numbers = "fp32",
                    .departure = variant.departure,
                    .iterations = iterations,
                    .arrived = 0};
            for (size_t t = 0; t < result.status.size(); ++t) {
                if (truth.materials[truth.material[t]].model != fitted_model || best.samples[t] < 9) continue;
                // of samples in [0, 1]: errors below are rounding
                const double least = 1.5 * best.samples[t] * 1e-8;
                const bool there =
                    double(result.error[t]) <= std::max(least, o_.within * o_.within * double(best.error[t]));
                ++row.problems;
                row.arrived += there;
                row.stalled += !there && result.status[t] == Status::stationary;
                row.not_finite += result.status[t] == Status::not_finite;
                row.error += double(result.error[t]);
            }
            for (double* share : {&row.arrived, &row.stalled, &row.not_finite}) *share /= double(row.problems);
            ReflectanceFit fit;
            fit.options = here;
            fit.parameters = result.parameters;
            fit.status = result.status;
            fit.samples = result.samples;
            const Contestant contestant = contestant_of(fit, *atlas);
            const JudgeResult train = judge(contestant, dataset, Split::train, at_pixel_centres);
            row.psnr = train.psnr();
            row.ape = train.ape();
            row.held_psnr = judge(contestant, dataset, Split::test, at_pixel_centres).psnr();
            rows_.push_back(row);
            rows_.back().error_ratio = row.error / rows_[first].error;
            say(rows_.back());
        }
    }
}

void Departures::write() {
    ResultFolder results = experiment_.open_results(culling_.front().renderer);
    CsvFile csv(results.path(), rows::fits);
    Table table({"problem", "optimizer", "floats", "left out", "arrived", "iterations", "stalled", "not finite", "E",
                 "PSNR", "held out"});
    const auto number = [](const char* format, double x) {
        return std::isnan(x) ? std::string() : fmt::format(fmt::runtime(format), x);
    };
    for (const Row& r : rows_) {
        csv.add({r.departure.id, r.departure.without, r.problem, r.optimizer, r.numbers, r.renderer, r.iterations,
                 r.problems, unless_nan(r.arrived), unless_nan(r.iterations_median), unless_nan(r.stalled),
                 unless_nan(r.not_finite), unless_nan(r.error), unless_nan(r.error_ratio), unless_nan(r.psnr),
                 unless_nan(r.ape), unless_nan(r.held_psnr)});
        table.add({r.problem, r.optimizer, r.numbers,
                   r.departure.id.empty() ? "nothing" : fmt::format("{}: {}", r.departure.id, r.departure.without),
                   number("{:.1f} %", 100 * r.arrived), number("{:g}", r.iterations_median),
                   number("{:.1f} %", 100 * r.stalled), number("{:.1f} %", 100 * r.not_finite),
                   number("× {:.4g}", r.error_ratio), number("{:.2f} dB", r.psnr), number("{:.2f} dB", r.held_psnr)});
    }
    csv.commit();
    write_rows(results.path(), rows::culling, culling_);
    Table work(rows::culling.header({}));
    for (const rows::Culling& row : culling_) work.add(rows::culling.fields(row));
    log_info(table.text());
    const std::string caption = fmt::format("{} and {}, {} scale; {}; {}", o_.dataset, o_.reflectance,
                                            experiment_.profile(), experiment_.cpu_device(), culling_.front().renderer);
    write_file(
        results.path() / "departures.md",
        fmt::format("# What mends of the paper's text are worth: {}\n\nEvery row leaves out one mend; docs/paper.md "
                    "numbers and explains them, docs/results.md the columns. lambda = {:g}.\n\n{}\n{}",
                    caption, o_.model.lambda_surface, table.markdown(), work.markdown()));
    experiment_.finish(results, caption);
}

void Departures::run() {
    dataset_ = experiment_.dataset(o_.dataset);
    light_field_maps();
    half_precision();
    culling();
    reflectance();
    write();
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("departures", argc, argv, [](radiafit::harness::Experiment& experiment) {
        radiafit::harness::Departures(experiment).run();
    });
}
