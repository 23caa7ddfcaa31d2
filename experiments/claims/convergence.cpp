#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"
#include "base/statistics.h"
#include "rounds.h"
#include "rules.h"

namespace radiafit::harness {
namespace {

const std::string datasets[] = {"star", "bust"};

/// Iterations to the tolerance, solver by solver, of all problems of a dataset at one lambda; below 0: not within the
/// cap.
class Arrivals {
public:
    Arrivals(const CsvTable& t, const std::string& dataset, double lambda, double cap) : cap_(cap) {
        for (size_t i = 0; i < t.row_count(); ++i) {
            if (t.text(i, "dataset") != dataset || t.number(i, "lambda") != lambda) continue;
            vertices_.insert(t.text(i, "vertex"));
            for (const char* solver : {"cg_paper", "sd", "sd_growing", "varpro"})
                iterations_[solver].push_back(t.number(i, solver));
            penalties_.push_back(t.number(i, "varpro_penalty"));
        }
    }
    size_t problems() const { return penalties_.size(); }
    size_t vertices() const { return vertices_.size(); }

    /// Iterations of solver `a` over those of `b`, problem by problem; never to arrive counts as arriving at the cap.
    std::vector<double> ratios(const char* a, const char* b) const {
        std::vector<double> out;
        for (size_t i = 0; i < problems(); ++i) out.push_back(counted(a, i) / counted(b, i));
        return out;
    }
    /// The same for the problems where varpro's objective is the paper's: no bounds are at work at its end.
    std::vector<double> comparable_ratios(const char* a, const char* b) const {
        std::vector<double> out;
        for (size_t i = 0; i < problems(); ++i)
            if (std::abs(penalties_[i]) <= 1e-3) out.push_back(counted(a, i) / counted(b, i));
        return out;
    }
    /// The same for the problems where both arrive.
    std::vector<double> arrived_ratios(const char* a, const char* b) const {
        std::vector<double> out;
        for (size_t i = 0; i < problems(); ++i)
            if (iterations_.at(a)[i] >= 0 && iterations_.at(b)[i] >= 0) out.push_back(counted(a, i) / counted(b, i));
        return out;
    }
    double median_iterations(const char* solver) const {
        std::vector<double> out;
        for (size_t i = 0; i < problems(); ++i) out.push_back(counted(solver, i));
        return median(std::move(out));
    }
    double censored(const char* solver) const {
        return double(std::ranges::count_if(iterations_.at(solver), [](double k) { return k < 0; })) /
               double(problems());
    }

private:
    double counted(const char* solver, size_t i) const {
        const double k = iterations_.at(solver)[i];
        return k < 0 ? cap_ : std::max(1.0, k);
    }

    double cap_;
    std::set<std::string> vertices_;
    std::map<std::string, std::vector<double>> iterations_;
    std::vector<double> penalties_;
};

/// Arrivals on both datasets, at the lambda that claims are judged at. Datasets that the run lacks are left out, and
/// the premise is noted as unmet.
std::map<std::string, Arrivals> judged_arrivals(const FinishedRun& run, const CsvTable& t, Judgement& j) {
    const double lambda = run.setting("lambda"), cap = run.setting("cap");
    std::map<std::string, Arrivals> out;
    for (const std::string& name : datasets) {
        Arrivals arrivals(t, name, lambda, cap);
        j.demand(arrivals.problems() > 0, "the " + name);
        if (arrivals.problems() > 0) out.emplace(name, std::move(arrivals));
    }
    j.demand(lambda == 1e-4, "lambda = 1e-4");
    j.demand(run.setting("tolerance") == 1.01, "1.01 of the least error");
    j.demand(cap >= 3000, fmt::format("caps of at least 3000 iterations, not {:g}", cap));
    return out;
}

/// Where the quotient of two figures lies for sure, if each lies in its interval.
std::optional<Interval> quotient(const std::optional<Interval>& above, const std::optional<Interval>& below) {
    if (!above || !below) return std::nullopt;
    return Interval{above->low / below->high, above->high / below->low};
}

constexpr double both = 0.975;  ///< confidence of each of two intervals that hold together in 95 %

Judgement iteration_ratio(const FinishedRun& run) {
    const CsvTable t = run.table("problems.csv"), summary = run.table("summary.csv");
    Judgement j;
    std::vector<std::string> found;
    for (const auto& [name, a] : judged_arrivals(run, t, j)) {
        const std::vector<double> ratios = a.ratios("sd", "cg_paper"), sure = a.arrived_ratios("sd", "cg_paper");
        const Figure figure = median_of_problems(ratios, a.vertices());
        j.measures.push_back({.of = name + ", SD's over CG's iterations", .figure = figure, .bound = at_least(5)});
        found.push_back(fmt::format("{} times on the {} (medians {:g} against {:g} iterations)", with_interval(figure),
                                    name, a.median_iterations("sd"), a.median_iterations("cg_paper")));
        j.beside.push_back(fmt::format(
            "{}: quartiles {:.3g} and {:.3g}; after {:g} iterations {} of SD's problems and {} of CG's have "
            "not arrived; where both have ({} of them), the median is {:.3g}",
            name, quantile(ratios, 0.25), quantile(ratios, 0.75), run.setting("cap"), percent(a.censored("sd")),
            percent(a.censored("cg_paper")), percent(double(sure.size()) / double(a.problems())), median(sure)));
        j.beside.push_back(fmt::format(
            "{}: by sweeps over the images, of which CG takes two an iteration, {:.3g} times; with a step "
            "that grows by a tenth while the error falls, SD takes {:.3g} times CG's iterations, {} not "
            "there at the cap",
            name, 0.5 * figure.value, median(a.ratios("sd_growing", "cg_paper")), percent(a.censored("sd_growing"))));
    }
    for (size_t i = 0; i < summary.row_count(); ++i)
        if (summary.number(i, "lambda") != run.setting("lambda"))
            j.beside.push_back(fmt::format(
                "{}, lambda = {}: median {:.3g} times, quartiles {:.3g} and {:.3g}; {} of SD's and {} of CG's problems "
                "not there after {}",
                summary.text(i, "dataset"), summary.text(i, "lambda"), summary.number(i, "ratio_median"),
                summary.number(i, "ratio_quartile1"), summary.number(i, "ratio_quartile3"),
                percent(summary.number(i, "sd_censored_share")), percent(summary.number(i, "cg_censored_share")),
                summary.text(i, "cap")));
    j.sentence = fmt::format(
        "To come within 1 % of the least error that any solver found, steepest descent takes {} as many iterations as "
        "conjugate gradients in the median problem.",
        fmt::join(found, ", "));
    return j;
}

Judgement better_minimum(const FinishedRun& run) {
    /// How many problems of the sample have their two errors apart, and in how many of those CG's is the lower.
    struct Pairs {
        double count = 0, apart = 0, lower = 0;
        std::set<std::string> vertices, apart_vertices;

        void add(const std::string& vertex, double cg, double sd) {
            ++count;
            vertices.insert(vertex);
            if (std::max(cg, sd) <= 1.01 * std::min(cg, sd)) return;
            ++apart;
            lower += cg < sd;
            apart_vertices.insert(vertex);
        }
    };
    const CsvTable t = run.table("ends.csv");
    Pairs minima, rested, all;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const std::string vertex = t.text(i, "dataset") + " " + t.text(i, "vertex");
        const auto both = [&](const char* cg, const char* sd) { return t.number(i, cg) != 0 && t.number(i, sd) != 0; };
        const double cg = t.number(i, "cg_error"), sd = t.number(i, "sd_error");
        all.add(vertex, cg, sd);
        if (both("cg_at_rest", "sd_at_rest")) rested.add(vertex, cg, sd);
        if (both("cg_minimum_at_rest", "sd_minimum_at_rest"))
            minima.add(vertex, t.number(i, "cg_minimum"), t.number(i, "sd_minimum"));
    }
    Judgement j;
    const double moving = 1 - minima.count / std::max(1.0, all.count);
    j.demand(all.count >= 300, fmt::format("a sample of at least 300 problems, not {:g}", all.count));
    j.demand(moving <= 0.1, fmt::format("minima, and {} of the problems did not come to rest", percent(moving)));
    j.demand(run.setting("lambda") == 1e-4, "lambda = 1e-4");
    const Figure share = share_of(minima.apart / std::max(1.0, minima.count), minima.vertices.size());
    const Figure won =
        minima.apart > 0 ? share_of(minima.lower / minima.apart, minima.apart_vertices.size()) : Figure();
    j.measures = {{.of = "minima more than 1 % apart", .figure = share, .bound = at_least(0.05), .unit = "%"},
                  {.of = "of those, CG's the lower", .figure = won, .bound = at_least(0.5), .unit = "%"}};
    for (const auto& [of, pairs] :
         {std::pair(fmt::format("after {:g} iterations, at rest or not", run.setting("ends_cap")), &all),
          std::pair(std::string("where both methods came to rest by themselves"), &rested)})
        j.beside.push_back(
            fmt::format("{}: of {:g} problems {:g} are more than 1 % apart, CG the lower in {:g} of them", of,
                        pairs->count, pairs->apart, pairs->lower));
    j.sentence = fmt::format(
        "Followed down to their minima, conjugate gradients and steepest descent end more than 1 % apart in {} of {:g} "
        "problems{}.",
        percent(share.value), minima.count,
        minima.apart > 0 ? fmt::format(", and in {} of those conjugate gradients end lower", percent(won.value)) : "");
    return j;
}

Judgement idle_before_arrival(const FinishedRun& run) {
    /// All problems under one rule and threshold.
    struct Setting {
        std::vector<double> stopped, arrived, final;
        std::set<std::string> vertices;

        /// Iterations after which half of the problems have arrived; infinite if never.
        double median_arrival() const {
            std::vector<double> k;
            for (const double at : arrived) k.push_back(at < 0 ? HUGE_VAL : at);
            std::ranges::sort(k);
            return k[k.size() / 2];
        }
        /// Share of the problems that still run just before the median one arrives, or when all is over.
        double active() const {
            const double last = median_arrival() - 1;
            return double(std::ranges::count_if(stopped, [&](double k) { return k < 0 || k > last; })) /
                   double(stopped.size());
        }
    };
    const CsvTable t = run.table("problems.csv");
    std::map<std::string, std::map<double, Setting>> rules[2];  // of CG, of SD
    for (size_t i = 0; i < t.row_count(); ++i) {
        Setting& s = rules[is_descent(t.text(i, "optimizer"))][t.text(i, "rule")][t.number(i, "levels")];
        s.stopped.push_back(t.number(i, "stopped_at"));
        s.arrived.push_back(t.number(i, "arrived_at"));
        s.final.push_back(t.number(i, "error_over_best"));
        s.vertices.insert(t.text(i, "vertex"));
    }
    const auto measures_of = [](const std::string& rule, double levels, const Setting& s) {
        const std::string name = fmt::format("{} below {:g}/255", rule, levels);
        return std::array{Measure{.of = name + ", the median problem's last error over its best",
                                  .figure = median_of_problems(s.final, s.vertices.size()),
                                  .bound = at_least(1.05)},
                          Measure{.of = name + ", still running before the median problem arrives",
                                  .figure = share_of(s.active(), s.vertices.size()),
                                  .bound = at_most(0.5),
                                  .unit = "%"}};
    };
    const auto outcome_of = [](const auto& measures) {
        const Judgement alone{.measures = {measures.begin(), measures.end()}};
        return alone.outcome();
    };
    constexpr Outcome from_best[] = {Outcome::holds, Outcome::undecided, Outcome::fails};

    Judgement j;
    const bool arrives = rules[0].contains("none") && std::isfinite(rules[0]["none"][0].median_arrival());
    j.demand(arrives, "optimizations that arrive where nothing stops them");
    j.demand(run.setting("tolerance") == 1.01 && run.setting("lambda") == 1e-4, "lambda = 1e-4 and 1.01 of the best");
    std::vector<std::string> found;
    for (const std::string rule : {"residual", "output change"}) {
        if (!rules[0].contains(rule)) throw UserError(fmt::format("problems.csv: no row of rule '{}'", rule));
        // The threshold that the rule comes out best at, the smallest of several.
        const Setting* best = nullptr;
        double best_levels = 0;
        std::optional<std::array<Measure, 2>> shown;
        for (const Outcome outcome : from_best)
            for (const auto& [levels, setting] : rules[0][rule]) {
                const auto measures = measures_of(rule, levels, setting);
                if (best || outcome_of(measures) != outcome) continue;
                best = &setting, best_levels = levels, shown = measures;
            }
        j.measures.insert(j.measures.end(), shown->begin(), shown->end());
        found.push_back(
            fmt::format("stopped when its {} is below {:g}/255, the median problem ends at {:.3g} times its "
                        "best error, and {} of all still run when it arrives or everything is over",
                        rule == "residual" ? rule : "change of output", best_levels, (*shown)[0].figure.value,
                        percent((*shown)[1].figure.value)));
        j.beside.push_back(fmt::format("the rule of the {} alone: {}", rule, to_string(outcome_of(*shown))));
        for (const size_t optimizer : {0, 1})
            for (const auto& [levels, setting] : rules[optimizer][rule]) {
                const auto measures = measures_of(rule, levels, setting);
                j.beside.push_back(
                    fmt::format("{}, {} below {:g}/255: the median problem ends at {} times its best; "
                                "{} still running before it arrives",
                                optimizer ? "SD" : "CG", rule, levels, with_interval(measures[0].figure),
                                percent(measures[1].figure.value)));
            }
    }
    std::vector<double> weights = column(run.table("weights.csv"), "weight");
    j.beside.push_back(fmt::format(
        "thresholds are of a pixel's residual; the rules' own are of a residual times the vertex's weight, whose root "
        "mean square is {:.3g} in the median vertex, and the residual's has the penalties in it",
        median(std::move(weights))));
    j.sentence = fmt::format("With conjugate gradients, {}.", fmt::join(found, "; "));
    return j;
}

Judgement newton_rate(const FinishedRun& run) {
    const CsvTable t = run.table("problems.csv");
    Judgement j;
    std::vector<std::string> found;
    for (const auto& [name, a] : judged_arrivals(run, t, j)) {
        const std::vector<double> ratios = a.comparable_ratios("cg_paper", "varpro");
        const double left_out = 1 - double(ratios.size()) / double(a.problems());
        const Figure figure = median_of_problems(ratios, size_t((1 - left_out) * double(a.vertices())));
        j.demand(left_out <= 0.25,
                 fmt::format("one objective, and in {} of the {}'s problems Newton's steps have another, for bounds",
                             percent(left_out), name));
        j.measures.push_back(
            {.of = name + ", CG's iterations over Newton's steps", .figure = figure, .bound = at_most(2)});
        found.push_back(fmt::format("{} times as many on the {} (medians {:g} against {:g})", with_interval(figure),
                                    name, a.median_iterations("cg_paper"), a.median_iterations("varpro")));
        j.beside.push_back(
            fmt::format("{}: {} of the problems are left out, where bounds are at work: Newton's steps take a smooth "
                        "penalty in place "
                        "of the paper's, and it makes more than 0.1 % of the error; with them the median is {:.3g}",
                        name, percent(left_out), median(a.ratios("cg_paper", "varpro"))));
    }
    j.sentence = fmt::format(
        "To come within 1 % of the least error, conjugate gradients take {} iterations as Newton's steps on the view "
        "map, "
        "with the surface maps solved for in closed form.",
        fmt::join(found, ", "));
    return j;
}

Judgement consistent_ratio(const FinishedRun& run) {
    const CsvTable t = run.table("problems.csv");
    Judgement j;
    struct Middle {
        double value;
        std::optional<Interval> interval;
    };
    std::vector<Middle> medians;
    std::vector<std::string> found;
    for (const auto& [name, a] : judged_arrivals(run, t, j)) {
        const std::vector<double> ratios = a.ratios("sd", "cg_paper");
        const double low = quantile(ratios, 0.25), high = quantile(ratios, 0.75);
        const Figure spread{high / low, quotient(quantile_interval(ratios, 0.75, a.vertices(), both),
                                                 quantile_interval(ratios, 0.25, a.vertices(), both))};
        j.measures.push_back({.of = name + ", upper over lower quartile", .figure = spread, .bound = at_most(3)});
        medians.push_back({median(ratios), quantile_interval(ratios, 0.5, a.vertices(), both)});
        found.push_back(fmt::format("from {:.3g} to {:.3g} on the {}", low, high, name));
        const std::vector<double> sure = a.arrived_ratios("sd", "cg_paper");
        j.beside.push_back(fmt::format("{}: median {:.3g}; where both arrive, quartiles {:.3g} and {:.3g}", name,
                                       medians.back().value, quantile(sure, 0.25), quantile(sure, 0.75)));
    }
    if (medians.size() == 2) {
        const bool swap = medians[0].value < medians[1].value;
        const Middle &above = medians[swap], &below = medians[!swap];
        j.measures.push_back({.of = "the larger dataset's median over the other's",
                              .figure = {above.value / below.value, quotient(above.interval, below.interval)},
                              .bound = between(1 / 1.5, 1.5)});
    }
    j.sentence = fmt::format(
        "For the middle half of the problems, steepest descent's iterations over conjugate "
        "gradients' lie {}.",
        fmt::join(found, " and "));
    return j;
}

}  // namespace

std::span<const Claim> convergence_claims() {
    static constexpr Claim table[] = {
        {"C1", "6.1, Fig. 7", "CG needs about a tenth of SD's iterations",
         "the median, over all problems, of SD's over CG's iterations to 1.01 of the least error any solver found is "
         "at least 5 on both datasets; who doesn't arrive counts as arriving at the cap",
         "fig7_convergence", iteration_ratio},
        {"C2", "6.1", "CG usually finds a better local minimum",
         "300 problems run until E_t falls by less than a millionth in 200 iterations, or for 30,000; a fast method "
         "goes on from there to the minimum: more than 5 % of the minima lie more than 1 % apart, and of those CG's "
         "is the lower in more than half",
         "fig7_convergence", better_minimum},
        {"C16", "5.3.2", "threshold stopping rules are too restrictive, and utilization falls as problems finish",
         "with CG under both rules, at some threshold that leaves the median problem above 1.05 of its best error, "
         "less than half of the problems are active before the median one is within 1.01, or ever; without a "
         "threshold the median problem arrives",
         "stopping", idle_before_arrival},
        {"C19", "3", "CG has the convergence rate of the Newton method",
         "iterations to 1.01 of the best error, CG's over Newton steps' (variable projection), of the problems where "
         "no bounds are at work, for those have one objective: median at most 2; not comparable where bounds are at "
         "work in more than a quarter",
         "fig7_convergence", newton_rate},
        {"C22", "6.1", "the ratio of CG's and SD's iterations is consistent across optimizations and datasets",
         "upper over lower quartile of C1's ratio at most 3, and the two datasets' medians within a factor of 1.5",
         "fig7_convergence", consistent_ratio},
    };
    return table;
}

}  // namespace radiafit::harness
