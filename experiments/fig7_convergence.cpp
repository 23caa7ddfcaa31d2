// Figure 7 of the paper: how fast conjugate gradients and steepest descent converge, in the paper's mode.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "app/limits.h"
#include "base/error.h"
#include "base/log.h"
#include "base/rng.h"
#include "base/statistics.h"
#include "experiment.h"
#include "report/csv.h"

namespace radiafit {
namespace {

constexpr Range<int> caps{10, limits::iterations.upper}, shown_problems{1, 6};

struct Options {
    std::vector<std::string> datasets = {"star", "bust"};
    std::string engine = "cpu";
    LfmOptions model;
    double tolerance = 1.01;
    int cap = 3000, modern_iterations = 400, problems = 3, seed = 7, shown_cg = 50, shown_sd = 500;

    explicit Options(Config& c) {
        c.read("datasets", datasets, check_light_field_shape);
        c.read("engine", engine, valid_option("engine"));
        read_maps(c, model);
        c.read("tolerance", tolerance, limits::tolerance);
        c.read("cap", cap, caps);
        c.read("modern_iterations", modern_iterations, limits::some_iterations);
        c.read("problems", problems, shown_problems);
        c.read("seed", seed, limits::draw_seed);
        c.read("shown_cg", shown_cg, limits::some_iterations);
        c.read("shown_sd", shown_sd, limits::some_iterations);
        c.finish();
    }
};

/// E_t of every problem after every iteration: errors[iteration][problem].
struct Run {
    std::vector<std::vector<float>> errors;
    std::vector<Status> status;
    double error_at(size_t iteration, size_t problem) const {
        return errors[std::min(iteration, errors.size() - 1)][problem];
    }
    /// First iteration with an error of at most `level`; -1 if none.
    int first_below(double level, size_t problem) const {
        const auto found =
            std::partition_point(errors.begin(), errors.end(), [&](const auto& row) { return row[problem] > level; });
        return found == errors.end() ? -1 : int(found - errors.begin());
    }
};

Run run(Record& record, const Dataset& dataset, const Options& o, const SharedSamples& samples, const char* optimizer,
        const char* mode, int iterations) {
    FitRequest request;
    request.set("engine", o.engine);
    request.set("optimizer", optimizer);
    request.set("mode", mode);
    request.model = o.model;
    request.iterations = iterations;
    Run out;
    out.status = solve_noting_errors(dataset, request, samples, out.errors, record).fit.status;
    return out;
}

struct Comparison {
    std::vector<size_t> problems;  ///< with samples
    std::vector<double> best;      ///< least error any solver reached
    std::vector<int> cg, sd;       ///< iterations to tolerance * best, -1 if never
    std::vector<double> ratio;     ///< of the problems whose CG finished; a censored SD counts as the cap
};

Comparison compare(const Run& cg, const Run& sd, const Run& modern, const Options& o) {
    Comparison c;
    for (size_t i = 0; i < cg.status.size(); ++i) {
        if (cg.status[i] == Status::no_samples || cg.status[i] == Status::not_finite) continue;
        const double best =
            std::min({cg.error_at(~size_t(0), i), sd.error_at(~size_t(0), i), modern.error_at(~size_t(0), i)});
        c.problems.push_back(i);
        c.best.push_back(best);
        c.cg.push_back(cg.first_below(o.tolerance * best, i));
        c.sd.push_back(sd.first_below(o.tolerance * best, i));
        if (c.cg.back() >= 0)
            c.ratio.push_back(double(c.sd.back() < 0 ? o.cap : c.sd.back()) / std::max(1, c.cg.back()));
    }
    return c;
}

double share(size_t part, size_t whole) { return whole ? double(part) / double(whole) : 0; }

void write_rows(const ResultFolder& results, const Dataset& dataset, const Options& o, const Run& cg, const Run& sd,
                const Comparison& c) {
    // three problems drawn by seed among those that both methods brought to the end
    std::vector<size_t> finished;
    for (size_t j = 0; j < c.problems.size(); ++j)
        if (c.cg[j] >= 0) finished.push_back(j);
    Rng rng(uint64_t(o.seed));
    CsvWriter curves(results.path() / (dataset.name + "_curves.csv"),
                     {"method", "shown", "vertex", "channel", "iteration", "error", "error_over_best"});
    for (int shown = 1; shown <= o.problems && !finished.empty(); ++shown) {
        const size_t j = finished[rng.index(uint32_t(finished.size()))];
        const auto add = [&](const char* method, const Run& run, int last) {
            for (int k = 0; k <= last; ++k) {
                const double e = run.error_at(size_t(k), c.problems[j]);
                curves.row({method, std::to_string(shown), std::to_string(c.problems[j] / 3),
                            std::string(1, "rgb"[c.problems[j] % 3]), std::to_string(k), fmt::format("{:.6g}", e),
                            fmt::format("{:.6g}", e / c.best[j])});
            }
        };
        add("cg", cg, std::min(o.shown_cg, o.cap));
        add("sd", sd, std::min(o.shown_sd, o.cap));
    }
    curves.commit();

    CsvWriter problems(results.path() / (dataset.name + "_problems.csv"),
                       {"vertex", "channel", "best_error", "cg_iterations", "sd_iterations"});
    for (size_t j = 0; j < c.problems.size(); ++j)
        problems.row({std::to_string(c.problems[j] / 3), std::string(1, "rgb"[c.problems[j] % 3]),
                      fmt::format("{:.6g}", c.best[j]), std::to_string(c.cg[j]), std::to_string(c.sd[j])});
    problems.commit();

    std::vector<double> sorted = c.ratio;
    std::sort(sorted.begin(), sorted.end());
    CsvWriter distribution(results.path() / (dataset.name + "_ratio.csv"), {"ratio", "share_below"});
    for (size_t i = 0; i < sorted.size(); ++i)
        distribution.row({fmt::format("{:.5g}", sorted[i]), fmt::format("{:.6f}", share(i + 1, sorted.size()))});
    distribution.commit();
}

/// The share of problems that are within the tolerance of the best error, by iteration, of every optimizer of the list.
/// Those that Figure 7 doesn't have run for as long as modern conjugate gradients.
void write_methods(ResultFolder& results, const Dataset& dataset, const Options& o, const SharedSamples& samples,
                   const std::map<Rule, const Run*>& at_hand, const Comparison& c) {
    std::vector<std::string> columns = {"iteration"};
    std::vector<std::vector<int>> reached;  // by method: sorted iterations
    for (const NamedRule& ours : named_rules()) {
        const auto found = at_hand.find(ours.rule);
        std::optional<Run> own;
        if (found == at_hand.end())
            own = run(results.record(), dataset, o, samples, ours.method->name, ours.mode, o.modern_iterations);
        const Run& one = own ? *own : *found->second;
        columns.push_back(ours.name);
        std::vector<int>& list = reached.emplace_back();
        for (size_t j = 0; j < c.problems.size(); ++j)
            if (const int k = one.first_below(o.tolerance * c.best[j], c.problems[j]); k >= 0) list.push_back(k);
        std::sort(list.begin(), list.end());
    }
    CsvWriter shares(results.path() / (dataset.name + "_methods.csv"), columns);
    for (int k = 0; k <= o.modern_iterations; ++k) {
        std::vector<std::string> row = {std::to_string(k)};
        for (const auto& list : reached)
            row.push_back(fmt::format(
                "{:.5f}",
                share(size_t(std::upper_bound(list.begin(), list.end(), k) - list.begin()), c.problems.size())));
        shares.row(row);
    }
    shares.commit();
}

std::vector<std::string> summary_row(const Dataset& dataset, const Options& o, const Run& cg, const Run& sd,
                                     const Comparison& c) {
    const auto count = [](const std::vector<int>& v) { return size_t(std::count(v.begin(), v.end(), -1)); };
    const auto doubles = [&](const std::vector<int>& v) {
        std::vector<double> out;
        for (int x : v) out.push_back(x < 0 ? o.cap : x);
        return out;
    };
    size_t better = 0;  // C2: CG's error against SD's at ten times the iterations
    for (size_t i : c.problems) better += cg.error_at(size_t(o.cap) / 10, i) < sd.error_at(size_t(o.cap), i);
    const auto number = [](double x) { return fmt::format("{:.4g}", x); };
    return {dataset.name,
            std::to_string(c.problems.size()),
            number(quantile(c.ratio, 0.25)),
            number(quantile(c.ratio, 0.5)),
            number(quantile(c.ratio, 0.75)),
            number(quantile(doubles(c.cg), 0.5)),
            number(quantile(doubles(c.sd), 0.5)),
            number(share(count(c.sd), c.problems.size())),
            number(share(count(c.cg), c.problems.size())),
            number(share(better, c.problems.size())),
            std::to_string(o.cap)};
}

void fig7(Experiment& experiment) {
    const Options o(experiment.config());
    ResultFolder results = experiment.open_results(experiment.cpu_device());
    CsvWriter summary(
        results.path() / "summary.csv",
        {"dataset", "problems", "ratio_quartile1", "ratio_median", "ratio_quartile3", "cg_median_iterations",
         "sd_median_iterations", "sd_censored_share", "cg_unfinished_share", "cg_better_at_tenth_share", "cap"});
    for (const std::string& shape : o.datasets) {
        const Dataset dataset = experiment.dataset(shape);
        FitRequest request;
        request.model = o.model;
        const TriangleAtlas atlas(dataset.mesh, o.model.surface_side);
        const SharedSamples samples = distribute(dataset, atlas, request);
        const Run cg = run(results.record(), dataset, o, samples, "cg", "paper", o.cap);
        const Run sd = run(results.record(), dataset, o, samples, "sd", "paper", o.cap);
        const Run modern = run(results.record(), dataset, o, samples, "cg", "modern", o.modern_iterations);
        const Comparison comparison = compare(cg, sd, modern, o);
        write_rows(results, dataset, o, cg, sd, comparison);
        write_methods(results, dataset, o, samples,
                      {{Rule::cg_paper, &cg}, {Rule::steepest_descent, &sd}, {Rule::cg_modern, &modern}}, comparison);
        const auto row = summary_row(dataset, o, cg, sd, comparison);
        summary.row(row);
        log_info(
            fmt::format("{}: steepest descent needs {} times the iterations of conjugate gradients (quartiles {} and "
                        "{}; {} of SD censored, "
                        "{} of CG unfinished at {})",
                        shape, row[3], row[2], row[4], row[7], row[8], o.cap));
    }
    summary.commit();
    results.commit();
    experiment.draw(results, fmt::format("{} engine ({}), {} scale stand-ins", o.engine, experiment.cpu_name(),
                                         experiment.profile()));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("fig7_convergence", argc, argv, radiafit::fig7); }
