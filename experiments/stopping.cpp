// Section 5.3.2: what the two threshold rules for stopping do to the problems and to the use that is made of the
// stream.
#include "rows/stopping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/log.h"
#include "base/statistics.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "report/csv.h"
#include "report/csv_file.h"
#include "report/table.h"
#include "vertex_bench.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::stopping;

constexpr Range<double> thresholds{1e-6, 1e6};

struct Options {
    std::string dataset = "star";
    LfmOptions model;
    std::vector<double> levels = {8, 4, 2, 1, 0.5};
    int vertices = 0, object = 1, seed = 1, cg_iterations = 100, sd_iterations = 1000, cap = 1000,
        rival_iterations = 400;
    double tolerance = 1.01;

    explicit Options(Config& c) {
        c.read("dataset", dataset, check_light_field_shape);
        read_maps(c, model);
        c.read("levels", levels, thresholds);
        c.read("vertices", vertices, drawn_vertices);
        c.read("object", object, limits::draw_seed);
        c.read("seed", seed, limits::draw_seed);
        c.read("cg_iterations", cg_iterations, limits::some_iterations);
        c.read("sd_iterations", sd_iterations, limits::some_iterations);
        c.read("cap", cap, limits::some_iterations);
        c.read("rival_iterations", rival_iterations, limits::some_iterations);
        c.read("tolerance", tolerance, limits::tolerance);
        c.finish();
        if (cap < cg_iterations) c.reject("cap", "needs at least `cg_iterations`");
    }
    double lambda() const { return double(model.lambda_surface); }
};

/// A way of stopping, under an optimizer.
struct Setting {
    const char* rule;  ///< of the two; "none" without a threshold
    double levels;     ///< 1/255 of the encoding's range, of a pixel's residual
    const char* optimizer;
    OptimizerOptions options;  ///< without the threshold
};

std::vector<Setting> settings(const Options& o) {
    std::vector<Setting> all;
    for (const auto& [optimizer, rule, iterations] : {std::tuple("cg", Rule::cg_paper, o.cg_iterations),
                                                      std::tuple("sd", Rule::steepest_descent, o.sd_iterations)}) {
        const OptimizerOptions options{.rule = rule, .iterations = iterations};
        all.push_back({"none", 0, optimizer, options});
        for (const char* stop : {"residual", "output change"})
            for (const double levels : o.levels) all.push_back({stop, levels, optimizer, options});
    }
    return all;
}

/// How a vertex's three problems went under a setting, against the least errors that any solver reached.
struct Stopped {
    std::array<int, 3> stopped_at, arrived_at;  ///< iterations; -1: never
    std::array<double, 3> final;                ///< error over the best
    std::array<std::vector<float>, 3> ratios;   ///< by iteration; ends when all three have been stopped
};

struct Vertex {
    uint32_t id;
    double weight;                  ///< root mean square of Lambda
    std::vector<Stopped> settings;  ///< in the order of settings()
};

/// A problem that some solver solved to the last digit has a best error of 0.
double over(double error, double best) {
    if (error == best) return 1;
    return best > 0 ? error / best : std::numeric_limits<double>::infinity();
}

Vertex solve(const Options& o, const std::vector<Setting>& all, BenchVertex& vertex) {
    Vertex out{vertex.id(), vertex.rms_weight(), {}};
    std::vector<Course> courses;
    for (const Setting& s : all) {
        OptimizerOptions options = s.options;
        // in the unit of the rules, which is a residual times Lambda
        const auto threshold = float(s.levels / 255 * out.weight);
        (s.rule == std::string("residual") ? options.stop_residual : options.stop_output_change) = threshold;
        courses.push_back(vertex.optimize(options));
    }
    std::array<double, 3> best = vertex.varpro(o.rival_iterations).end;
    const auto take_best = [&](const std::array<double, 3>& end) {
        for (size_t c = 0; c < 3; ++c) best[c] = std::min(best[c], end[c]);
    };
    for (const Course& course : courses) take_best(course.end);
    take_best(vertex.optimize({.rule = Rule::cg_paper, .iterations = o.cap}).end);
    take_best(vertex.optimize({.rule = Rule::cg_modern, .iterations = o.rival_iterations}).end);
    for (const Course& course : courses) {
        Stopped& stopped = out.settings.emplace_back();
        stopped.stopped_at = course.stopped_at;
        for (size_t c = 0; c < 3; ++c) {
            stopped.arrived_at[c] = course.first_below(o.tolerance * best[c], c, course.iterations());
            stopped.final[c] = over(course.end[c], best[c]);
            for (const auto& errors : course.errors) stopped.ratios[c].push_back(float(over(errors[c], best[c])));
        }
    }
    return out;
}

/// All problems under a setting.
struct Summary {
    std::vector<double> active, median;              ///< [iteration] share still running; median of E_t over the best
    int first_below_half = -1, median_reached = -1;  ///< iterations; -1: never
    double short_of_best = 0;                        ///< share of the problems that don't end within the tolerance

    double mean_active() const {
        double sum = 0;
        for (const double share : active) sum += share;
        return sum / double(active.size());
    }
};

Summary summarize(const Options& o, const std::vector<Vertex>& vertices, const Setting& setting, size_t s) {
    Summary out;
    const double count = double(3 * vertices.size());
    for (int k = 0; k <= setting.options.iterations; ++k) {
        double active = 0;
        std::vector<double> ratios;
        for (const Vertex& vertex : vertices)
            for (size_t c = 0; c < 3; ++c) {
                const Stopped& one = vertex.settings[s];
                active += one.stopped_at[c] < 0 || one.stopped_at[c] > k;
                ratios.push_back(double(one.ratios[c][std::min(size_t(k), one.ratios[c].size() - 1)]));
            }
        out.active.push_back(active / count);
        out.median.push_back(median(std::move(ratios)));
        if (out.first_below_half < 0 && out.active.back() < 0.5) out.first_below_half = k;
        if (out.median_reached < 0 && out.median.back() <= o.tolerance) out.median_reached = k;
    }
    for (const Vertex& vertex : vertices)
        for (size_t c = 0; c < 3; ++c) out.short_of_best += (vertex.settings[s].arrived_at[c] < 0) / count;
    return out;
}

void write(const ResultFolder& results, const Options& o, const std::vector<Setting>& all,
           const std::vector<Vertex>& vertices) {
    CsvFile problems(results.path(), rows::problems);
    CsvFile weights(results.path(), rows::weights);
    CsvFile curves(results.path(), rows::curves);
    CsvFile rules(results.path(), rows::rules);
    Table table({"rule", "threshold", "optimizer", "half idle at iteration", "median arrives at", "it ends at",
                 "active on average"});
    std::vector<double> all_weights;
    for (const Vertex& vertex : vertices) {
        weights.add({vertex.id, vertex.weight});
        all_weights.push_back(vertex.weight);
    }
    for (size_t s = 0; s < all.size(); ++s) {
        const auto& [rule, levels, optimizer, options] = all[s];
        for (const Vertex& vertex : vertices)
            for (size_t c = 0; c < 3; ++c) {
                const Stopped& one = vertex.settings[s];
                problems.add({rule, levels, optimizer, vertex.id, std::string(1, "rgb"[c]), one.stopped_at[c],
                              one.arrived_at[c], one.final[c]});
            }
        const Summary sum = summarize(o, vertices, all[s], s);
        for (const int k : sparse_iterations(options.iterations))
            curves.add({rule, levels, optimizer, k, sum.active[size_t(k)], sum.median[size_t(k)]});
        rules.add({rule, levels, optimizer, sum.first_below_half, sum.median_reached, sum.median.back(),
                   sum.mean_active(), sum.short_of_best, options.iterations});
        const auto iteration = [&](int k) { return k < 0 ? "never" : std::to_string(k); };
        table.add({rule, levels > 0 ? fmt::format("{:g}/255", levels) : "", optimizer, iteration(sum.first_below_half),
                   iteration(sum.median_reached), fmt::format("{:.3f} x best", sum.median.back()),
                   fmt::format("{:.1f} %", 100 * sum.mean_active())});
    }
    problems.commit();
    weights.commit();
    curves.commit();
    rules.commit();
    log_info(
        fmt::format("threshold rules for stopping; a pixel's residual counts {:.2f} of itself in the median "
                    "vertex\n{}",
                    median(all_weights), table.text()));
}

void stopping(Experiment& experiment) {
    const Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset, {}, {}, uint64_t(o.object));
    const VertexBench bench(dataset, o.model, o.vertices, o.seed);
    ResultFolder results = experiment.open_results(experiment.cpu_device());
    const std::vector<Setting> all = settings(o);
    std::vector<Vertex> vertices(bench.seen().size());
    bench.for_each(o.lambda(), "vertices", [&](size_t i, BenchVertex& vertex) { vertices[i] = solve(o, all, vertex); });
    write(results, o, all, vertices);
    experiment.finish(
        results, fmt::format("synthetic stand-in of the paper's {}, {} scale; lambda = {:g}, paper mode; {}", o.dataset,
                             experiment.profile(), o.lambda(), experiment.cpu_device()));
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("stopping", argc, argv, radiafit::harness::stopping);
}
