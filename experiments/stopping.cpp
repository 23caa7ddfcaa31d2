// Section 5.3.2: what the two threshold rules for stopping do to the problems and to the use that is made of the
// stream.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/limits.h"
#include "base/log.h"
#include "base/statistics.h"
#include "experiment.h"
#include "report/csv.h"
#include "report/table.h"

namespace radiafit {
namespace {

constexpr Range<double> thresholds{1e-6, 1e6};

struct Options {
    std::string dataset = "star", engine = "cpu";
    LfmOptions model;
    std::vector<double> levels = {8, 4, 2, 1, 0.5};
    int iterations = 100, cap = 500, modern_iterations = 400;
    double tolerance = 1.01;

    explicit Options(Config& c) {
        c.read("dataset", dataset, check_light_field_shape);
        c.read("engine", engine, valid_option("engine"));
        read_maps(c, model);
        c.read("levels", levels, thresholds);
        c.read("iterations", iterations, limits::some_iterations);
        c.read("cap", cap, limits::some_iterations);
        c.read("modern_iterations", modern_iterations, limits::some_iterations);
        c.read("tolerance", tolerance, limits::tolerance);
        c.finish();
        if (cap < iterations) c.reject("cap", "needs at least `iterations`");
    }
};

struct Run {
    std::vector<std::vector<float>> errors;  ///< [iteration][problem]
    std::vector<double> active;              ///< [iteration] share of the problems with samples
    std::vector<uint32_t> samples;           ///< [problem]
};

FitRequest request_of(const Options& o, const char* optimizer) {
    FitRequest request;
    request.set("engine", o.engine);
    request.set("optimizer", optimizer);
    request.set("mode", "paper");
    request.model = o.model;
    request.iterations = o.iterations;
    return request;
}

Run run(Record& record, const Dataset& dataset, const FitRequest& request, const SharedSamples& samples) {
    Run out;
    const FitOutcome fit = solve_noting_errors(dataset, request, samples, out.errors, record);
    out.samples = fit.fit.samples;
    const auto seen = double(std::count_if(out.samples.begin(), out.samples.end(), [](uint32_t n) { return n > 0; }));
    for (const TraceRow& row : fit.trace.rows) out.active.push_back(double(row.active) / seen);
    return out;
}

/// Where a run stands after each iteration, against the least error that any solver reached on each problem.
struct Course {
    std::vector<double> active, median;              ///< [iteration] share still running; median of E_t over the best
    int first_below_half = -1, median_reached = -1;  ///< iterations; -1: never
    double stopped_short = 0;                        ///< share of the stopped that aren't within the tolerance

    /// More than half of the problems are idle before the median one has arrived.
    bool idle_before_arrival() const {
        return first_below_half >= 0 && (median_reached < 0 || first_below_half < median_reached);
    }
    double mean_active() const {
        double sum = 0;
        for (double share : active) sum += share;
        return sum / double(active.size());
    }
};

Course course_of(const Run& run, const std::vector<double>& best, double tolerance) {
    Course course{.active = run.active, .median = {}};
    std::vector<double> ratios;
    for (size_t k = 0; k < run.errors.size(); ++k) {
        ratios.clear();
        for (size_t i = 0; i < best.size(); ++i)
            if (run.samples[i] && best[i] > 0) ratios.push_back(double(run.errors[k][i]) / best[i]);
        course.median.push_back(median(ratios));
        if (course.first_below_half < 0 && course.active[k] < 0.5) course.first_below_half = int(k);
        if (course.median_reached < 0 && course.median.back() <= tolerance) course.median_reached = int(k);
    }
    const auto short_of_it =
        double(std::count_if(ratios.begin(), ratios.end(), [&](double ratio) { return ratio > tolerance; }));
    course.stopped_short = short_of_it / double(ratios.size());
    return course;
}

void stopping(Experiment& experiment) {
    const Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset);
    const TriangleAtlas atlas(dataset.mesh, o.model.surface_side);
    const SharedSamples samples = distribute(dataset, atlas, request_of(o, "cg"));
    ResultFolder results = experiment.open_results(experiment.cpu_device());

    // As in fig7_convergence: the least of both optimizers without thresholds, and of ours.
    std::vector<double> best(3 * dataset.mesh.vertex_count(), HUGE_VAL);
    Run free_runs[2];
    const auto take_best = [&](const Run& run) {
        for (size_t i = 0; i < best.size(); ++i) best[i] = std::min(best[i], double(run.errors.back()[i]));
    };
    constexpr const char* optimizers[] = {"cg", "sd"};
    for (int i = 0; i < 2; ++i) {
        FitRequest request = request_of(o, optimizers[i]);
        request.iterations = o.cap;
        free_runs[i] = run(results.record(), dataset, request, samples);
        take_best(free_runs[i]);
        const size_t shown = std::min(free_runs[i].errors.size(), size_t(o.iterations) + 1);
        free_runs[i].errors.resize(shown);
        free_runs[i].active.resize(shown);
    }
    FitRequest modern = request_of(o, "cg");
    modern.set("mode", "modern");
    modern.iterations = o.modern_iterations;
    take_best(run(results.record(), dataset, modern, samples));

    CsvWriter curves(results.path() / "curves.csv",
                     {"rule", "levels", "optimizer", "iteration", "active_share", "median_error_over_best"});
    CsvWriter rows(results.path() / "rules.csv",
                   {"rule", "levels", "optimizer", "first_below_half", "median_reached", "idle_before_arrival",
                    "mean_active_share", "short_of_best_share", "iterations"});
    Table table({"rule", "threshold", "optimizer", "half idle at iteration", "median arrives at", "active on average"});
    const auto add = [&](const char* rule, double levels, const char* optimizer, const Course& course) {
        const std::string threshold = fmt::format("{:g}", levels);
        for (size_t k = 0; k < course.active.size(); ++k)
            curves.row({rule, threshold, optimizer, std::to_string(k), fmt::format("{:.5f}", course.active[k]),
                        fmt::format("{:.6g}", course.median[k])});
        rows.row({rule, threshold, optimizer, std::to_string(course.first_below_half),
                  std::to_string(course.median_reached), course.idle_before_arrival() ? "1" : "0",
                  fmt::format("{:.5f}", course.mean_active()), fmt::format("{:.5f}", course.stopped_short),
                  std::to_string(course.active.size() - 1)});
        const auto iteration = [&](int k) { return k < 0 ? "never" : std::to_string(k); };
        table.add({rule, levels > 0 ? threshold + " levels" : "none", optimizer, iteration(course.first_below_half),
                   iteration(course.median_reached), fmt::format("{:.1f} %", 100 * course.mean_active())});
    };
    for (int i = 0; i < 2; ++i) {
        const Course free_course = course_of(free_runs[i], best, o.tolerance);
        for (const char* rule : {"residual", "output change"}) {
            add(rule, 0, optimizers[i], free_course);
            for (double levels : o.levels) {
                FitRequest request = request_of(o, optimizers[i]);
                (rule[0] == 'r' ? request.stop_residual : request.stop_output_change) = levels / 255;
                add(rule, levels, optimizers[i],
                    course_of(run(results.record(), dataset, request, samples), best, o.tolerance));
            }
        }
    }
    curves.commit();
    rows.commit();
    results.commit();
    log_info("threshold rules for stopping\n" + table.text());
    experiment.draw(results, fmt::format("{} ({} scale), conjugate gradients, paper mode, {} engine ({})", dataset.name,
                                         experiment.profile(), o.engine, experiment.cpu_name()));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("stopping", argc, argv, radiafit::stopping); }
