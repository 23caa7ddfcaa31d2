// Figure 7 of the paper: how fast conjugate gradients and steepest descent converge, in the paper's mode; and to which
// ends both come when they run on.
#include "rows/fig7_convergence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "base/rng.h"
#include "base/statistics.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "report/csv.h"
#include "report/csv_file.h"
#include "vertex_bench.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::fig7_convergence;

constexpr Range<int> caps{10, limits::iterations.upper}, shown_problems{1, 6};

struct Options {
    std::vector<std::string> datasets = {"star", "bust"};
    LfmOptions model;
    std::vector<double> other_lambdas = {1e-3, 1e-2};
    double tolerance = 1.01;
    int vertices = 0, cap = 3000, other_cap = 1000, rival_iterations = 400, ends = 60, ends_cap = 30000, problems = 3;
    int seed = 7, object = 1;

    explicit Options(Config& c) {
        c.read("datasets", datasets, check_light_field_shape);
        read_maps(c, model);
        c.read("other_lambdas", other_lambdas, limits::weight);
        c.read("tolerance", tolerance, limits::tolerance);
        c.read("vertices", vertices, drawn_vertices);
        c.read("cap", cap, caps);
        c.read("other_cap", other_cap, caps);
        c.read("rival_iterations", rival_iterations, limits::some_iterations);
        c.read("ends", ends, limits::repetitions);
        c.read("ends_cap", ends_cap, caps);
        c.read("problems", problems, shown_problems);
        c.read("object", object, limits::draw_seed);
        c.read("seed", seed, limits::draw_seed);
        c.finish();
        if (ends_cap < cap) c.reject("ends_cap", "needs at least `cap`");
        if (std::ranges::count(other_lambdas, model.lambda_surface, [](double x) { return float(x); }))
            c.reject("other_lambdas", "has `lambda` among them");
    }
    double lambda() const { return double(model.lambda_surface); }
};

/// An optimizer, and the column of its iterations.
struct Entrant {
    std::string name;
    OptimizerOptions options;
    bool capped = true;  ///< runs to the cap; the others are candidates for the least error
};

enum : size_t { cg, sd, methods_of_paper };
constexpr const char* newton_name = "varpro";  ///< comes behind all entrants

std::vector<Entrant> entrants() {
    std::vector<Entrant> all(methods_of_paper);
    all[cg] = {"cg_paper", {.rule = Rule::cg_paper}};
    all[sd] = {"sd", {.rule = Rule::steepest_descent}};
    all.push_back({"sd_growing", {.rule = Rule::steepest_descent, .left_out = WITHOUT_FIXED_STEP}});
    for (const NamedRule& ours : named_rules()) {
        if (ours.rule == Rule::cg_paper || ours.rule == Rule::steepest_descent) continue;
        all.push_back({ours.name, {.rule = ours.rule}, false});
        std::ranges::replace(all.back().name, ' ', '_');
    }
    return all;
}

/// Where an optimizer ends, and the minimum there: our conjugate gradients go on from its end until they rest.
struct End {
    double error;
    int iterations;
    bool at_rest;
    double minimum;
    bool minimum_at_rest;
};

/// One of a vertex's three problems under every solver.
struct Problem {
    double best = 0;          ///< least error that any of them ended with
    std::string best_solver;  ///< whose
    double penalty = 0;  ///< what the paper's penalty for bounds, in place of ours, adds to varpro's error; a share
    std::vector<int> arrived;  ///< [solver] iterations to tolerance * best; -1: never within the cap
    std::vector<End> ends;     ///< [method of the paper], of vertices whose ends are compared
    std::vector<double> curves[methods_of_paper];  ///< error by iteration, of problems that are shown
};

std::string channel_name(size_t channel) { return std::string(1, "rgb"[channel]); }

/// Names of the columns of iterations.
std::vector<std::string> solver_names() {
    std::vector<std::string> names;
    for (const Entrant& e : entrants()) names.push_back(e.name);
    names.push_back(newton_name);
    return names;
}

struct Files {
    CsvFile<rows::Problem> problems;
    CsvFile<rows::End> ends;
    CsvFile<rows::Point> curves;
    CsvFile<rows::Summary> summary;
    explicit Files(const std::filesystem::path& folder)
        : problems(folder, rows::problems, solver_names()),
          ends(folder, rows::ends),
          curves(folder, rows::curves),
          summary(folder, rows::summary) {}
};

/// All solvers on all problems of a dataset at one lambda. At the one that claims are judged at, some vertices run on
/// to their ends, and some problems are shown.
class Contest {
public:
    Contest(const Options& o, const VertexBench& bench, const std::string& dataset, double lambda, bool judged);
    void run() {
        bench_.for_each(lambda_, fmt::format("{}, lambda {:g}, vertices", dataset_, lambda_),
                        [&](size_t i, BenchVertex& vertex) { solve(i, vertex); });
    }
    void write(Files& files) const;

private:
    void solve(size_t i, BenchVertex& vertex);
    void summarize(Files& files) const;
    double counted(const Problem& p, size_t solver) const {
        return p.arrived[solver] < 0 ? double(cap_) : double(p.arrived[solver]);
    }

    const Options& o_;
    const VertexBench& bench_;
    const std::string& dataset_;
    double lambda_;
    int cap_;
    const std::vector<Entrant> entrants_ = entrants();
    std::vector<std::array<Problem, 3>> problems_;  ///< [vertices with samples]
    std::vector<size_t> to_ends_;                   ///< places among those
    std::vector<size_t> shown_;                     ///< problems: three times the vertex's place plus the channel
};

Contest::Contest(const Options& o, const VertexBench& bench, const std::string& dataset, double lambda, bool judged)
    : o_(o), bench_(bench), dataset_(dataset), lambda_(lambda), cap_(judged ? o.cap : o.other_cap) {
    problems_.resize(bench.seen().size());
    if (!judged) return;
    to_ends_ = bench.draw(size_t(o.ends), uint64_t(o.seed));
    Rng rng(uint64_t(o.seed));
    const size_t count = 3 * problems_.size();
    while (shown_.size() < std::min(size_t(o.problems), count)) {
        const size_t drawn = rng.index(uint32_t(count));
        if (!std::ranges::count(shown_, drawn)) shown_.push_back(drawn);
    }
}

void Contest::solve(size_t i, BenchVertex& vertex) {
    const bool to_ends = std::ranges::binary_search(to_ends_, i);
    std::vector<Course> courses, minima;
    for (size_t s = 0; s < entrants_.size(); ++s) {
        OptimizerOptions options = entrants_[s].options;
        options.iterations = !entrants_[s].capped              ? o_.rival_iterations
                             : to_ends && s < methods_of_paper ? o_.ends_cap
                                                               : cap_;
        courses.push_back(vertex.optimize(options));
        if (to_ends && s < methods_of_paper)
            minima.push_back(vertex.go_on({.rule = Rule::cg_modern, .iterations = o_.ends_cap}));
    }
    courses.push_back(vertex.varpro(o_.rival_iterations));
    const Course& newton = courses.back();
    for (size_t c = 0; c < 3; ++c) {
        Problem& problem = problems_[i][c];
        const auto best = std::ranges::min_element(courses, {}, [&](const Course& course) { return course.end[c]; });
        problem.best = best->end[c];
        problem.best_solver = &*best == &newton ? newton_name : entrants_[size_t(best - courses.begin())].name;
        problem.penalty = newton.end[c] / newton.errors.back()[c] - 1;
        for (const Course& course : courses)
            problem.arrived.push_back(course.first_below(o_.tolerance * problem.best, c, cap_));
        for (size_t s = 0; s < methods_of_paper; ++s) {
            const Course& course = courses[s];
            if (to_ends)
                problem.ends.push_back(
                    {course.end[c], course.iterations(), course.at_rest[c], minima[s].end[c], minima[s].at_rest[c]});
            if (std::ranges::count(shown_, 3 * i + c))
                for (int k = 0; k <= cap_; ++k) problem.curves[s].push_back(course.error(k, c));
        }
    }
}

void Contest::write(Files& files) const {
    for (size_t i = 0; i < problems_.size(); ++i)
        for (size_t c = 0; c < 3; ++c) {
            const Problem& p = problems_[i][c];
            const uint32_t vertex = bench_.seen()[i];
            files.problems.add(
                {dataset_, lambda_, vertex, channel_name(c), p.best, p.best_solver, p.penalty, p.arrived});
            if (p.ends.empty()) continue;
            const End &a = p.ends[cg], &b = p.ends[sd];
            files.ends.add({dataset_, vertex, channel_name(c), a.error, b.error, a.iterations, b.iterations, a.at_rest,
                            b.at_rest, a.minimum, b.minimum, a.minimum_at_rest, b.minimum_at_rest});
        }
    for (size_t shown = 0; shown < shown_.size(); ++shown) {
        const size_t i = shown_[shown] / 3, c = shown_[shown] % 3;
        const Problem& p = problems_[i][c];
        for (size_t s = 0; s < methods_of_paper; ++s)
            for (const int k : sparse_iterations(cap_)) {
                const double error = p.curves[s][size_t(k)];
                files.curves.add({dataset_, s == cg ? "cg" : "sd", shown + 1, bench_.seen()[i], channel_name(c), k,
                                  error, error / p.best});
            }
    }
    summarize(files);
}

void Contest::summarize(Files& files) const {
    const size_t newton = entrants_.size();
    std::vector<double> ratios, cg_iterations, sd_iterations, newton_iterations;
    double cg_censored = 0, sd_censored = 0;
    for (const auto& vertex : problems_)
        for (const Problem& p : vertex) {
            cg_iterations.push_back(counted(p, cg));
            sd_iterations.push_back(counted(p, sd));
            newton_iterations.push_back(counted(p, newton));
            ratios.push_back(std::max(1.0, sd_iterations.back()) / std::max(1.0, cg_iterations.back()));
            cg_censored += p.arrived[cg] < 0;
            sd_censored += p.arrived[sd] < 0;
        }
    const double count = double(ratios.size());
    files.summary.add({dataset_, lambda_, ratios.size(), cap_, quantile(ratios, 0.25), median(ratios),
                       quantile(ratios, 0.75), median(cg_iterations), median(sd_iterations), median(newton_iterations),
                       cg_censored / count, sd_censored / count});
    log_info(fmt::format(
        "{}, lambda {:g}: steepest descent needs {:.3g} times the iterations of conjugate gradients (quartiles {:.3g} "
        "and {:.3g}); after {}, {:.1f} % and {:.1f} % of the problems are not there",
        dataset_, lambda_, median(ratios), quantile(ratios, 0.25), quantile(ratios, 0.75), cap_,
        100 * sd_censored / count, 100 * cg_censored / count));
}

void fig7(Experiment& experiment) {
    const Options o(experiment.config());
    ResultFolder results = experiment.open_results(experiment.cpu_device());
    Files files(results.path());
    for (const std::string& shape : o.datasets) {
        const Dataset dataset = experiment.dataset(shape, {}, {}, uint64_t(o.object));
        const VertexBench bench(dataset, o.model, o.vertices, o.seed);
        const auto run = [&](double lambda, bool judged) {
            Contest contest(o, bench, dataset.name, lambda, judged);
            contest.run();
            contest.write(files);
        };
        run(o.lambda(), true);
        for (const double lambda : o.other_lambdas) run(lambda, false);
    }
    files.problems.commit();
    files.ends.commit();
    files.curves.commit();
    files.summary.commit();
    experiment.finish(
        results, fmt::format("{} vertices of each of the synthetic stand-ins of the paper's star and bust, {} scale; "
                             "lambda = {:g}; {}",
                             o.vertices ? std::to_string(o.vertices) : "all", experiment.profile(), o.lambda(),
                             experiment.cpu_device()));
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("fig7_convergence", argc, argv, radiafit::harness::fig7);
}
