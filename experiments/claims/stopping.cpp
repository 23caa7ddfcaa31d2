#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/statistics.h"
#include "rounds.h"

namespace radiafit::harness {
namespace {

Evidence idle_before_arrival(const FinishedRun& run) {
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
        return std::array{Measure{.name = "last error",
                                  .of = name + ", the median problem's last error over its best",
                                  .figure = median_of_problems(s.final, s.vertices.size()),
                                  .bound = {.least = 1.05}},
                          Measure{.name = "active",
                                  .of = name + ", still running before the median problem arrives",
                                  .figure = share_of(s.active(), s.vertices.size()),
                                  .unit = "%",
                                  .bound = {.most = 0.5}}};
    };
    const auto outcome_of = [](const auto& measures) {
        const Judgement alone{.measures = {measures.begin(), measures.end()}};
        return alone.outcome();
    };
    constexpr Outcome from_best[] = {Outcome::holds, Outcome::undecided, Outcome::fails};
    constexpr double judged_levels = 1;

    Evidence e;
    const bool arrives = rules[0].contains("none") && std::isfinite(rules[0]["none"][0].median_arrival());
    e.premise("arrival without a threshold", arrives, "optimizations that arrive where nothing stops them");
    e.premise("tolerance and lambda", run.setting("tolerance") == 1.01 && run.setting("lambda") == 1e-4,
              "lambda = 1e-4 and 1.01 of the best");
    std::vector<std::string> found;
    bool judged = true;
    for (const std::string rule : {"residual", "output change"}) {
        if (!rules[0].contains(rule)) throw UserError(fmt::format("problems.csv: no row of rule '{}'", rule));
        const auto add = [&](const std::array<Measure, 2>& measures, const char* where) {
            for (Measure m : measures) e.measure(m.name + where, m.of, m.figure, m.unit);
        };
        // The threshold that the rule comes out best at, the smallest of several.
        std::optional<std::array<Measure, 2>> shown;
        for (const Outcome outcome : from_best)
            for (const auto& [levels, setting] : rules[0][rule]) {
                const auto measures = measures_of(rule, levels, setting);
                if (!shown && outcome_of(measures) == outcome) shown = measures;
            }
        add(*shown, " at the best threshold");
        const auto fixed = rules[0][rule].find(judged_levels);
        judged = judged && fixed != rules[0][rule].end();
        if (fixed != rules[0][rule].end()) {
            const auto measures = measures_of(rule, judged_levels, fixed->second);
            add(measures, " at 1/255");
            found.push_back(
                fmt::format("stopped when its {} is below 1/255, the median problem ends at {:.3g} times its "
                            "best error, and {} of all still run when it arrives or everything is over",
                            rule == "residual" ? rule : "change of output", measures[0].figure.value,
                            percent(measures[1].figure.value)));
            e.beside.push_back(
                fmt::format("the rule of the {} alone, at 1/255: {}", rule, to_string(outcome_of(measures))));
        }
        for (const size_t optimizer : {0, 1})
            for (const auto& [levels, setting] : rules[optimizer][rule]) {
                const auto measures = measures_of(rule, levels, setting);
                e.beside.push_back(
                    fmt::format("{}, {} below {:g}/255: the median problem ends at {} times its best; "
                                "{} still running before it arrives",
                                optimizer ? "SD" : "CG", rule, levels, with_interval(measures[0].figure),
                                percent(measures[1].figure.value)));
            }
    }
    e.premise("1/255", judged, "a threshold of 1/255, under both rules");
    std::vector<double> weights = column(run.table("weights.csv"), "weight");
    e.beside.push_back(fmt::format(
        "thresholds are of a pixel's residual; the rules' own are of a residual times the vertex's weight, whose root "
        "mean square is {:.3g} in the median vertex, and the residual's has the penalties in it",
        median(std::move(weights))));
    e.sentence = fmt::format("With conjugate gradients, {}.", fmt::join(found, "; "));
    return e;
}

}  // namespace

std::span<const ClaimCode> stopping_claims() {
    static constexpr ClaimCode table[] = {{"C16", idle_before_arrival}};
    return table;
}

}  // namespace radiafit::harness
