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

constexpr double unbounded = 1e300;  ///< of a ratio that may be anything above; finite, so that quantiles are numbers

/// Iterations to the tolerance, solver by solver, of all problems of a dataset at one lambda; below 0: not within the
/// cap.
class Arrivals {
public:
    Arrivals(const CsvTable& t, const std::string& dataset, double lambda, double cap) : cap_(cap) {
        for (size_t i = 0; i < t.row_count(); ++i) {
            if (t.text(i, "dataset") != dataset || t.number(i, "lambda") != lambda) continue;
            vertices_.insert(t.text(i, "vertex"));
            for (const char* solver : {"cg_paper", "cg_modern", "sd", "sd_growing", "varpro"})
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
    /// The least and the most that each ratio may be, of the problems of which either arrives.
    std::pair<std::vector<double>, std::vector<double>> bounded_ratios(const char* a, const char* b) const {
        std::pair<std::vector<double>, std::vector<double>> out;
        for (size_t i = 0; i < problems(); ++i) {
            const bool a_arrives = iterations_.at(a)[i] >= 0, b_arrives = iterations_.at(b)[i] >= 0;
            if (!a_arrives && !b_arrives) continue;
            const double ratio = counted(a, i) / counted(b, i);
            out.first.push_back(b_arrives ? ratio : 0);
            out.second.push_back(a_arrives ? ratio : unbounded);
        }
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
std::map<std::string, Arrivals> judged_arrivals(const FinishedRun& run, const CsvTable& t, Evidence& e) {
    const double lambda = run.setting("lambda"), cap = run.setting("cap");
    std::map<std::string, Arrivals> out;
    for (const std::string& name : datasets) {
        Arrivals arrivals(t, name, lambda, cap);
        e.premise("the " + name, arrivals.problems() > 0, "the " + name);
        if (arrivals.problems() > 0) out.emplace(name, std::move(arrivals));
    }
    e.premise("lambda", lambda == 1e-4, "lambda = 1e-4");
    e.premise("tolerance", run.setting("tolerance") == 1.01, "1.01 of the least error");
    e.premise("cap", cap >= 3000, fmt::format("caps of at least 3000 iterations, not {:g}", cap));
    return out;
}

/// The median of figures that are known within bounds: the least that it may be, and an interval over all that it may.
Figure median_within(const std::pair<std::vector<double>, std::vector<double>>& bounds, size_t independent) {
    if (bounds.first.empty()) return {};
    Figure figure{median(bounds.first)};
    const auto low = median_interval(bounds.first, independent), high = median_interval(bounds.second, independent);
    if (low && high) figure.interval = Interval{low->low, high->high < unbounded / 1e6 ? high->high : HUGE_VAL};
    return figure;
}

/// Where the quotient of two figures lies for sure, if each lies in its interval.
std::optional<Interval> quotient(const std::optional<Interval>& above, const std::optional<Interval>& below) {
    if (!above || !below) return std::nullopt;
    return Interval{above->low / below->high, above->high / below->low};
}

constexpr double both = 0.975;  ///< confidence of each of two intervals that hold together in 95 %

Evidence iteration_ratio(const FinishedRun& run) {
    const CsvTable t = run.table("problems.csv"), summary = run.table("summary.csv");
    Evidence e;
    const double lambda = run.setting("lambda"), cap = run.setting("cap");
    std::map<double, std::vector<std::string>> elsewhere;  // [lambda]
    for (size_t i = 0; i < summary.row_count(); ++i) {
        const double other = summary.number(i, "lambda");
        if (other == lambda) continue;
        const std::string& name = summary.text(i, "dataset");
        const Arrivals a(t, name, other, summary.number(i, "cap"));
        const auto bounds = a.bounded_ratios("sd", "cg_paper");
        if (bounds.first.empty()) continue;
        const Figure figure = median_within(bounds, a.vertices());
        elsewhere[other].push_back(fmt::format("{} on the {}", with_interval(figure), name));
        e.beside.push_back(fmt::format(
            "{}, lambda = {:g}, cap {:g}: {} times, of the {} of the problems of which either arrives; {} of SD's and "
            "{} of CG's do not",
            name, other, summary.number(i, "cap"), with_interval(figure),
            percent(double(bounds.first.size()) / double(a.problems())), percent(a.censored("sd")),
            percent(a.censored("cg_paper"))));
    }
    std::vector<std::string> found;
    for (const auto& [name, a] : judged_arrivals(run, t, e)) {
        const std::vector<double> ratios = a.ratios("sd", "cg_paper"), sure = a.arrived_ratios("sd", "cg_paper");
        const auto bounds = a.bounded_ratios("sd", "cg_paper");
        const Figure counted = median_of_problems(ratios, a.vertices()), bounded = median_within(bounds, a.vertices());
        e.measure("iterations, bounded", name + ", SD's over CG's iterations, where either arrives", bounded, "times");
        e.measure("iterations", name + ", SD's over CG's iterations, the cap counted", counted, "times");
        found.push_back(fmt::format("{} times on the {}, {:.3g} times in the {} of its problems where both arrive",
                                    with_interval(bounded), name, median(sure),
                                    percent(double(sure.size()) / double(a.problems()))));
        e.beside.push_back(fmt::format(
            "{}: medians of {:g} iterations by SD, {:g} by CG; quartiles of the ratio {:.3g} and {:.3g}; after {:g} "
            "iterations {} of SD's problems and {} of CG's have not arrived; where both have ({} of them), the median "
            "is {:.3g}",
            name, a.median_iterations("sd"), a.median_iterations("cg_paper"), quantile(ratios, 0.25),
            quantile(ratios, 0.75), cap, percent(a.censored("sd")), percent(a.censored("cg_paper")),
            percent(double(sure.size()) / double(a.problems())), median(sure)));
        e.beside.push_back(fmt::format(
            "{}: by sweeps over the images, of which CG takes two an iteration, {:.3g} times; with a step "
            "that grows by a tenth while the error falls, SD takes {:.3g} times CG's iterations, {} not "
            "there at the cap",
            name, 0.5 * bounded.value, median(a.ratios("sd_growing", "cg_paper")), percent(a.censored("sd_growing"))));
    }
    std::vector<std::string> at_others;
    for (const auto& [other, figures] : elsewhere)
        at_others.push_back(fmt::format("at lambda = {:g} {}", other, fmt::join(figures, " and ")));
    e.sentence = fmt::format(
        "To come within 1 % of the least error that any solver found, steepest descent takes as many iterations as "
        "conjugate gradients {}: the median of problems of which either arrives within {:g} iterations, at lambda = "
        "{:g}, where the interval reaches over all that the others' ratios may be. That is half as many times CG's "
        "sweeps over the images{}.",
        fmt::join(found, "; "), cap, lambda,
        at_others.empty() ? "" : fmt::format("; with that cap, {}", fmt::join(at_others, ", ")));
    return e;
}

Evidence better_minimum(const FinishedRun& run) {
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
    Evidence e;
    const double moving = 1 - minima.count / std::max(1.0, all.count);
    e.premise("ends", all.count >= 300, fmt::format("a sample of at least 300 problems, not {:g}", all.count));
    e.premise("minima", moving <= 0.1,
              fmt::format("minima, and {} of the problems did not come to rest", percent(moving)));
    e.premise("lambda", run.setting("lambda") == 1e-4, "lambda = 1e-4");
    const auto add = [&](const char* what, const Pairs& pairs) {
        const Figure share = share_of(pairs.apart / std::max(1.0, pairs.count), pairs.vertices.size());
        const Figure won =
            pairs.apart > 0 ? share_of(pairs.lower / pairs.apart, pairs.apart_vertices.size()) : Figure();
        e.measure(fmt::format("{} apart", what), fmt::format("{} more than 1 % apart", what), share, "%");
        e.measure(fmt::format("{}, CG lower", what), fmt::format("of those {}, CG's the lower", what), won, "%");
        return std::pair(share.value, won.value);
    };
    const auto [ends_share, ends_won] = add("ends", all);
    const auto [minima_share, minima_won] = add("minima", minima);
    e.beside.push_back(fmt::format(
        "where both methods came to rest by themselves: of {:g} problems {:g} are more than 1 % apart, CG the lower in "
        "{:g} of them",
        rested.count, rested.apart, rested.lower));
    e.sentence = fmt::format(
        "Run until they hardly move, or for {:g} iterations, conjugate gradients and steepest descent end more than "
        "1 % apart in {} of {:g} problems, and in {} of those conjugate gradients end lower; followed down from there "
        "to their minima, {} remain apart, conjugate gradients lower in {} of those: what separates the ends is mostly "
        "how far they came, not which minimum.",
        run.setting("ends_cap"), percent(ends_share), all.count, percent(ends_won), percent(minima_share),
        percent(minima_won));
    return e;
}

Evidence newton_rate(const FinishedRun& run) {
    const CsvTable t = run.table("problems.csv");
    Evidence e;
    std::vector<std::string> found, modern;
    for (const auto& [name, a] : judged_arrivals(run, t, e)) {
        const std::vector<double> ratios = a.comparable_ratios("cg_paper", "varpro");
        const double left_out = 1 - double(ratios.size()) / double(a.problems());
        const Figure figure = median_of_problems(ratios, size_t((1 - left_out) * double(a.vertices())));
        e.premise("comparable problems", left_out <= 0.25,
                  fmt::format("one objective, and in {} of the {}'s problems Newton's steps have another, for bounds",
                              percent(left_out), name));
        e.measure("CG over Newton", name + ", CG's iterations over Newton's steps", figure, "times");
        modern.push_back(fmt::format("{:.3g} ({})", median(a.comparable_ratios("cg_modern", "varpro")), name));
        found.push_back(fmt::format("{} times as many on the {} (medians {:g} against {:g})", with_interval(figure),
                                    name, a.median_iterations("cg_paper"), a.median_iterations("varpro")));
        e.beside.push_back(
            fmt::format("{}: {} of the problems are left out, where bounds are at work: Newton's steps take a smooth "
                        "penalty in place "
                        "of the paper's, and it makes more than 0.1 % of the error; with them the median is {:.3g}",
                        name, percent(left_out), median(a.ratios("cg_paper", "varpro"))));
    }
    e.sentence = fmt::format(
        "To come within 1 % of the least error, conjugate gradients take {} iterations as Newton's steps on the view "
        "map, with the surface maps solved for in closed form; such a step costs O(N^3) and is no method of the paper. "
        "Preconditioned conjugate gradients, which the paper does not have either, take {} times as many.",
        fmt::join(found, ", "), fmt::join(modern, ", "));
    return e;
}

Evidence consistent_ratio(const FinishedRun& run) {
    const CsvTable t = run.table("problems.csv");
    Evidence e;
    struct Middle {
        double value;
        std::optional<Interval> interval;
    };
    std::vector<Middle> medians;
    std::vector<std::string> found;
    for (const auto& [name, a] : judged_arrivals(run, t, e)) {
        const std::vector<double> ratios = a.ratios("sd", "cg_paper");
        const double low = quantile(ratios, 0.25), high = quantile(ratios, 0.75);
        const Figure spread{high / low, quotient(quantile_interval(ratios, 0.75, a.vertices(), both),
                                                 quantile_interval(ratios, 0.25, a.vertices(), both))};
        e.measure("quartiles", name + ", upper over lower quartile", spread, "times");
        medians.push_back({median(ratios), quantile_interval(ratios, 0.5, a.vertices(), both)});
        found.push_back(fmt::format("from {:.3g} to {:.3g} on the {}", low, high, name));
        const std::vector<double> sure = a.arrived_ratios("sd", "cg_paper");
        e.beside.push_back(fmt::format("{}: median {:.3g}; where both arrive, quartiles {:.3g} and {:.3g}", name,
                                       medians.back().value, quantile(sure, 0.25), quantile(sure, 0.75)));
    }
    if (medians.size() == 2) {
        const bool swap = medians[0].value < medians[1].value;
        const Middle &above = medians[swap], &below = medians[!swap];
        e.measure("datasets", "the larger dataset's median over the other's",
                  {above.value / below.value, quotient(above.interval, below.interval)}, "times");
    }
    e.sentence = fmt::format(
        "For the middle half of the problems, steepest descent's iterations over conjugate "
        "gradients' lie {}.",
        fmt::join(found, " and "));
    return e;
}

}  // namespace

std::span<const ClaimCode> convergence_claims() {
    static constexpr ClaimCode table[] = {
        {"C1", iteration_ratio}, {"C2", better_minimum}, {"C19", newton_rate}, {"C22", consistent_ratio}};
    return table;
}

}  // namespace radiafit::harness
