// Figure 9 of the paper: error of factorization (PCA) and of nonlinear optimization at the same high resolution, and of
// the CPU in 32-bit and OpenGL in 16-bit floats at a low one, on training and on held-out views.
#include "rows/fig9_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/atomic_file.h"
#include "base/log.h"
#include "eval/judge.h"
#include "experiment.h"
#include "fitting/fit_options.h"
#include "fitting/limits.h"
#include "report/csv.h"
#include "report/csv_file.h"
#include "report/table.h"
#include "samples/projected_sides.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::fig9_error;

constexpr Range<double> mean_texels{0, double(TriangleTile::texels_of(largest_side)), "0: one side for all"};

struct Options {
    std::vector<std::string> datasets = {"star", "bust"};
    std::vector<int> seeds = {1, 2, 3}, terms = {1, 2, 3};
    std::string capture;
    int high_side = 16, low_side = 8, iterations = 100, modern_iterations = 40, opengl_iterations = 40;
    double high_texels = 144;
    std::vector<double> lambda_surface = {1e-2}, lambda_view = {0.1}, other_lambdas = {1e-3, 1e-4};
    std::vector<int> refills = {10};
    int validation = 8;

    explicit Options(Config& c) {
        c.read("datasets", datasets, check_light_field_shape);
        c.read("seeds", seeds, limits::draw_seed);
        c.read("capture", capture);
        c.read("terms", terms, limits::terms);
        c.read("high_side", high_side, limits::map_side);
        c.read("high_texels", high_texels, mean_texels);
        c.read("low_side", low_side, limits::map_side);
        c.read("iterations", iterations, limits::iterations);
        c.read("modern_iterations", modern_iterations, limits::iterations);
        c.read("opengl_iterations", opengl_iterations, limits::iterations);
        c.read("lambda_surface", lambda_surface, limits::weight);
        c.read("lambda_view", lambda_view, limits::weight);
        c.read("other_lambdas", other_lambdas, limits::weight);
        c.read("refills", refills, limits::refills);
        c.read("validation", validation, limits::validation);
        c.finish();
        if (validation < 2) c.reject("validation", "is 2 at least: some views to fit, some to choose by");
    }
    /// A request in the paper's mode, with the first of the weights.
    FitRequest request(int side) const {
        FitRequest r;
        r.set("mode", "paper");
        r.model.surface_side = r.model.view_side = side;
        r.model.terms = terms.front();
        r.iterations = iterations;
        return weighted(r, lambda_surface.front(), lambda_view.front());
    }
    /// density: texels per pixel, with a separate side for each triangle; 0: one side for all.
    FitRequest high_request(double density, const char* solver = "stream") const {
        FitRequest r = request(high_side);
        r.solver = solver;
        r.texels_per_pixel = density;
        return r;
    }
    static FitRequest weighted(FitRequest r, double surface, double view) {
        r.model.lambda_surface = float(surface);
        r.model.lambda_view = float(view);
        return r;
    }
};

/// A fit's options in a row, empty where they mean nothing to it.
class Told {
public:
    explicit Told(const FitRequest& request) : request_(request), facts_(facts_of(request)) {}
    std::string text(const char* option) const {
        return find_fit_option(option).means_something(facts_) ? request_.text(option) : "";
    }

private:
    const FitRequest& request_;
    FitFacts facts_;
};

struct Row {
    std::string dataset, seed, method, weights, renderer;
    FitRequest request;
    JudgeResult train, held;
    int surface_side = 0;       ///< the largest
    double surface_texels = 0;  ///< mean over triangles
    double invented_share = 0, seconds = 0;
};

/// One candidate of a choice by validation views.
struct Trial {
    std::string dataset, seed, method;
    FitRequest request;
    JudgeResult judged;
    bool chosen = false;
};

/// The requests that did best on the validation views of one dataset, for all datasets of its shape.
struct Chosen {
    double density;  ///< of surface maps at the high resolution, chosen by their number of texels
    FitRequest high, low, pca;
};

class Contest {
public:
    Contest(const Options& options, Experiment& experiment) : options_(options), experiment_(experiment) {}

    Chosen choose(const Dataset& dataset, const std::string& seed) {
        const Options& o = options_;
        const double density = o.high_texels > 0 ? density_for(projected_areas(dataset, dataset.split(false)),
                                                               o.high_texels, limits::texels_per_pixel.upper)
                                                 : 0;
        const auto weights = [&](const FitRequest& request) {
            std::vector<FitRequest> requests;
            for (const double surface : o.lambda_surface)
                for (const double view : o.lambda_view) requests.push_back(Options::weighted(request, surface, view));
            return requests;
        };
        return {density, best_of(dataset, seed, "cg-high", weights(o.high_request(density))),
                best_of(dataset, seed, "cg-low", weights(o.request(o.low_side))),
                best_refills(dataset, seed, o.high_request(density, "pca"))};
    }

    /// Runs all methods with one term; with more terms, if asked for, only what Figure 9 compares on the CPU.
    void run(const Dataset& dataset, const std::string& seed, const Chosen& chosen, bool more_terms) {
        const Options& o = options_;
        const auto add = [&](const char* method, const std::string& weights, const FitRequest& request) {
            add_row(dataset, seed, method, weights, request, solve(dataset, request));
        };
        add("mean", "", o.high_request(chosen.density, "mean"));
        FitRequest published = chosen.pca;
        published.refills = 0;
        const std::vector<FitOutcome> pca =
            solve_by_refills(dataset, chosen.pca, std::array{published.refills, chosen.pca.refills});
        add_row(dataset, seed, "pca-published", "", published, pca[0]);
        add_row(dataset, seed, "pca-refilled", "", chosen.pca, pca[1]);
        add("cg-high", "chosen", chosen.high);
        for (const double lambda : o.other_lambdas)
            add("cg-high", fmt::format("{}", lambda), Options::weighted(chosen.high, lambda, lambda));
        FitRequest modern = chosen.high;
        modern.set("mode", "modern");
        modern.iterations = o.modern_iterations;
        add("cg-modern-high", "chosen", modern);
        add("cg-low", "chosen", chosen.low);
        FitRequest brief = chosen.low;
        brief.iterations = o.opengl_iterations;
        add("cg-low-brief", "chosen", brief);
        brief.set("engine", "fragment").set("passes", "paper").set("storage", "fp16").set("sums", "fp16");
        add("cg-low-fp16", "chosen", brief);
        for (size_t i = 1; more_terms && i < o.terms.size(); ++i) {
            const auto with_terms = [&](FitRequest request) {
                request.model.terms = o.terms[i];
                return request;
            };
            add("pca-refilled", "", with_terms(chosen.pca));
            add("cg-high", "chosen", with_terms(chosen.high));
            add("cg-low", "chosen", with_terms(chosen.low));
        }
    }
    const std::vector<Row>& rows() const { return rows_; }
    const std::vector<Trial>& trials() const { return trials_; }

private:
    /// The candidate of the highest PSNR on validation views; a single one needs no trial.
    FitRequest best_of(const Dataset& dataset, const std::string& seed, const std::string& method,
                       std::vector<FitRequest> candidates) {
        if (candidates.size() == 1) return candidates.front();
        const Dataset validated = for_validation(dataset, options_.validation);
        const size_t first = trials_.size();
        for (FitRequest& request : candidates) {
            request.validation = options_.validation;
            add_trial(validated, seed, method, request, solve(dataset, request));
        }
        return best_since(first);
    }

    /// The request with the best number of PCA's refills.
    FitRequest best_refills(const Dataset& dataset, const std::string& seed, FitRequest request) {
        std::vector<int> refills = options_.refills;
        std::ranges::sort(refills);
        request.refills = refills.front();
        if (refills.size() == 1) return request;
        const Dataset validated = for_validation(dataset, options_.validation);
        const size_t first = trials_.size();
        request.validation = options_.validation;
        const std::vector<FitOutcome> outcomes = solve_by_refills(dataset, request, refills);
        for (size_t i = 0; i < refills.size(); ++i) {
            request.refills = refills[i];
            add_trial(validated, seed, "pca-refilled", request, outcomes[i]);
        }
        return best_since(first);
    }

    /// `validated`: the dataset with its validation views held out.
    void add_trial(const Dataset& validated, const std::string& seed, const std::string& method,
                   const FitRequest& request, const FitOutcome& out) {
        trials_.push_back(
            {.dataset = validated.name,
             .seed = seed,
             .method = method,
             .request = request,
             .judged = judge(contestant_of(out.fit, validated.mesh), validated, Split::validation, at_pixel_centres)});
        log_info(fmt::format("{}, {}, weights {:g} and {:g}, {} refills: {:.2f} dB on validation views", validated.name,
                             method, request.model.lambda_surface, request.model.lambda_view, request.refills,
                             trials_.back().judged.psnr()));
    }

    /// Of the trials from `first` on.
    FitRequest best_since(size_t first) {
        const auto best =
            std::max_element(trials_.begin() + ptrdiff_t(first), trials_.end(),
                             [](const auto& a, const auto& b) { return a.judged.psnr() < b.judged.psnr(); });
        best->chosen = true;
        FitRequest request = best->request;
        request.validation = 0;
        return request;
    }

    void add_row(const Dataset& dataset, const std::string& seed, const std::string& method, const std::string& weights,
                 const FitRequest& request, const FitOutcome& out) {
        note_gl(out, experiment_.record());
        Row row{.dataset = dataset.name,
                .seed = seed,
                .method = method,
                .weights = weights,
                .renderer = out.gl_renderer.empty() ? experiment_.cpu_name() : out.gl_renderer,
                .request = request,
                .train = judge(contestant_of(out.fit, dataset.mesh), dataset, Split::train, at_pixel_centres),
                .held = judge(contestant_of(out.fit, dataset.mesh), dataset, Split::test, at_pixel_centres),
                .surface_side = out.fit.options.surface_side,
                .surface_texels = double(surface_atlas(dataset.mesh, out.fit.options).used_texels()) /
                                  double(dataset.mesh.triangle_count()),
                .invented_share = out.resampling.invented_share(),
                .seconds = out.times.total};
        log_info(fmt::format("{}, {}, K = {}: PSNR {:.2f} dB in training, {:.2f} dB held out; {:.1f} s", row.dataset,
                             method, request.model.terms, row.train.psnr(), row.held.psnr(), row.seconds));
        rows_.push_back(std::move(row));
    }

    Options options_;
    Experiment& experiment_;
    std::vector<Row> rows_;
    std::vector<Trial> trials_;
};

void write_errors(const std::filesystem::path& folder, const std::vector<Row>& fits) {
    CsvFile csv(folder, rows::errors);
    Table table({"method", "training PSNR", "APE", "held-out PSNR", "APE", "invented"});
    for (const Row& r : fits) {
        const Told told(r.request);
        const bool pca = facts_of(r.request).resamples;
        csv.add({r.dataset,
                 r.seed,
                 r.method,
                 r.weights,
                 r.request.text("terms"),
                 r.surface_side,
                 told.text("view_side"),
                 told.text("mode"),
                 told.text("passes"),
                 r.request.text("storage"),
                 told.text("sums"),
                 told.text("iterations"),
                 told.text("refills"),
                 told.text("lambda_surface"),
                 told.text("lambda_view"),
                 r.train.psnr(),
                 r.train.ape(),
                 r.held.psnr(),
                 r.held.ape(),
                 pca ? std::optional(r.invented_share) : std::nullopt,
                 r.seconds,
                 r.surface_texels,
                 told.text("texels_per_pixel"),
                 r.renderer});
        table.add({fmt::format("{} {}, {}{}{}, K = {}", r.dataset, r.seed, r.method,
                               r.weights.empty() ? "" : ", weights ", r.weights, r.request.model.terms),
                   fmt::format("{:.2f} dB", r.train.psnr()), fmt::format("{:.2f}", r.train.ape()),
                   fmt::format("{:.2f} dB", r.held.psnr()), fmt::format("{:.2f}", r.held.ape()),
                   pca ? fmt::format("{:.0f}%", 100 * r.invented_share) : ""});
    }
    csv.commit();
    write_file(folder / "fig9_error.md", table.markdown());
    log_info("what is left of the error\n" + table.text());
}

void write_choice(const std::filesystem::path& folder, const std::vector<Trial>& trials) {
    if (trials.empty()) return;
    CsvFile csv(folder, rows::choice);
    for (const Trial& t : trials) {
        const Told told(t.request);
        csv.add({t.dataset, t.seed, t.method, told.text("lambda_surface"), told.text("lambda_view"),
                 told.text("refills"), t.judged.psnr(), t.judged.ape(), t.chosen});
    }
    csv.commit();
}

void fig9(Experiment& experiment) {
    const Options o(experiment.config());
    std::optional<Dataset> capture;
    if (!o.capture.empty()) require_light_field(capture.emplace(experiment.open(o.capture)));
    Contest contest(o, experiment);
    for (const std::string& shape : o.datasets) {
        std::optional<Chosen> chosen;
        for (const int seed : o.seeds) {
            const Dataset dataset = experiment.dataset(shape, {}, {}, uint64_t(seed));
            const std::string text = std::to_string(seed);
            const bool first = !chosen;
            if (first) chosen = contest.choose(dataset, text);
            contest.run(dataset, text, *chosen, first);
        }
    }
    if (capture) contest.run(*capture, "", contest.choose(*capture, ""), true);
    std::string renderer;
    for (const Row& row : contest.rows())
        if (row.method == "cg-low-fp16") renderer = row.renderer;
    ResultFolder results = experiment.open_results(renderer);
    write_errors(results.path(), contest.rows());
    write_choice(results.path(), contest.trials());
    write_halves(results, FitRequest().context);
    experiment.finish(results, fmt::format("{} scale, foreground pixels; {}; OpenGL: {}", experiment.profile(),
                                           experiment.cpu_device(), renderer));
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("fig9_error", argc, argv, radiafit::harness::fig9);
}
