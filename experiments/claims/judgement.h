#pragma once
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "report/table.h"

/// A claim is judged by figures with 95 % intervals, each against a bound: what lies wholly within the bound holds,
/// what lies wholly outside does not, and what straddles it is undecided.
namespace radiafit::harness {

/// A measured figure.
struct Figure {
    double value = std::nan("");
    std::optional<Interval> interval = {};  ///< 95 %; none where there were too few repetitions for one
};

/// Counted, not measured: the same in every run.
Figure exact(double value);
/// The median of one figure's values, one for each interleaved repetition. An interval needs nine.
Figure median_of_rounds(const std::vector<double>& values);
/// The median over problems, of which so many are independent of each other: a vertex's three channels are not.
Figure median_of_problems(const std::vector<double>& values, size_t independent);
/// The share of `independent` things of which `share` have a property.
Figure share_of(double share, size_t independent);
/// The mean of an accuracy figure over datasets made from different seeds. An interval needs three.
Figure mean_of_seeds(const std::vector<double>& values);

std::string percent(double share);                ///< "12.3 %"
std::string with_interval(const Figure& figure);  ///< "11.9 (11.2 to 12.6)"; the value alone where there is none

/// Where a figure has to lie.
struct Bound {
    double least = -HUGE_VAL, most = HUGE_VAL;
    std::string text(const std::string& unit) const;  ///< "at least 5", "10 to 30 %"
};
inline Bound at_least(double x) { return {.least = x}; }
inline Bound at_most(double x) { return {.most = x}; }
inline Bound between(double low, double high) { return {low, high}; }

enum class Outcome { holds, fails, undecided };
const char* to_string(Outcome outcome);  ///< "holds", "does not hold", "undecided"

/// A figure, and what the rule asks of it.
struct Measure {
    std::string of;  ///< what was measured: "star, CG"
    Figure figure;
    Bound bound;                        ///< where it holds
    std::optional<Bound> failing = {};  ///< where it does not; none: wherever it does not hold
    std::string unit = {};              ///< "%" shows a share times 100
    Outcome outcome() const;
    std::string value_text() const;     ///< "11.9"
    std::string interval_text() const;  ///< "11.2 to 12.6", or "too few repetitions", or "counted"
};

/// What a rule finds in the rows of one run.
struct Judgement {
    std::vector<Measure> measures = {};
    std::vector<std::string> beside = {};  ///< what the rule does not ask for and a reader wants to know
    std::vector<std::string> unmet = {};   ///< why the figures do not speak about the claim
    std::optional<Outcome> own = {};       ///< of a rule that is more than "all measures hold"
    std::string sentence = {};             ///< what was found, for a reader who knows only the paper
    std::string renderer = {};             ///< of the figures; empty: what run.json says
    std::string not_run = {};              ///< why there is nothing to judge
    std::string no_rule = {};              ///< why no bound is set: the figures are only reported

    /// What the rule asks of the run itself, such as a graphics chip.
    void demand(bool given, const std::string& what) {
        if (!given) unmet.push_back(what);
    }
    /// For claims about a graphics chip's time.
    void demand_graphics_chip();

    /// By the measures alone.
    Outcome outcome() const;
    /// "holds", "does not hold", "undecided", "not comparable" or "not run".
    std::string verdict() const;
    /// Why the verdict is no plain yes or no; empty where it is.
    std::string reason() const;
    nlohmann::ordered_json json() const;
    /// The measures for people.
    Table table() const;
};

}  // namespace radiafit::harness
