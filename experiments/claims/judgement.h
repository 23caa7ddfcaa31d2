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
/// what lies wholly outside does not, and what straddles it is undecided, as is what lies between a bound and another
/// from which on a claim does not hold.
namespace radiafit::harness {

/// A measured figure.
struct Figure {
    double value = std::nan("");
    std::optional<Interval> interval = {};  ///< 95 %; none where there were too few repetitions for one
};

/// Counted, not measured: the same in every run.
Figure exact(double value);
inline constexpr size_t least_rounds = 9;  ///< interleaved repetitions that an interval needs
/// The median of one figure's values, one for each repetition.
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
    std::string text(const std::string& unit) const;  ///< "at least 5", "10 to 30 %"; empty: anywhere
};

enum class Outcome { holds, fails, undecided };
const char* to_string(Outcome outcome);  ///< "holds", "does not hold", "undecided"

/// A figure, and what a rule asks of it.
struct Measure {
    std::string name;  ///< by which rules ask for it: "iterations"; several measures may have one
    std::string of;    ///< what was measured: "star, SD's over CG's iterations"
    Figure figure;
    std::string unit = {};              ///< "%" shows a share times 100
    Bound bound = {};                   ///< where it holds
    std::optional<Bound> failing = {};  ///< where it does not; none: wherever it does not hold
    Outcome outcome() const;
    const char* why_undecided() const;  ///< of such an outcome
    std::string value_text() const;     ///< "11.9"
    std::string interval_text() const;  ///< "11.2 to 12.6", or "too few repetitions", or "counted"
};

/// One reading of a claim, with what it asks for; see rules.toml.
struct Rule {
    struct Asked {
        std::string of;  ///< Measure::name
        Bound bound = {};
        std::optional<Bound> failing = {};
    };
    std::string name;           ///< of another reading: "as mathematics"; else empty
    std::string text = {};      ///< in words
    std::string reason = {};    ///< why this is a fair reading of the paper's sentence
    std::string computed = {};  ///< how, where the words leave that open; may be empty
    std::string scale = {};     ///< number of problems, images, repetitions
    std::string since = {};     ///< the day on which it was registered: "2026-11-27"; of a former one empty
    std::string until = {};     ///< of a former one, the day on which it was replaced
    std::string changed = {};   ///< of a former one, why
    std::string none = {};      ///< why no bound is set: the figures are only reported
    std::vector<std::string> premises = {};  ///< Premise::name
    std::vector<Asked> asked = {};           ///< none: all figures, and nothing of them
};

/// Something that a run may have to be.
struct Premise {
    std::string name;   ///< by which rules ask for it: "graphics chip"
    std::string words;  ///< behind "the claim is about "
    bool met;
};

/// What a claim's code finds in the rows of one run, for whatever rules ask.
struct Evidence {
    std::vector<Measure> measures = {};
    std::vector<std::string> beside = {};  ///< what no rule asks for and a reader wants to know
    std::vector<Premise> premises = {};
    std::string sentence = {};  ///< what was found, for a reader who knows only the paper
    std::string renderer = {};  ///< of the figures; empty: what run.json says
    std::string not_run = {};   ///< why there is nothing to judge

    void measure(std::string name, std::string of, const Figure& figure, std::string unit = "") {
        measures.push_back({std::move(name), std::move(of), figure, std::move(unit)});
    }
    /// A rule that asks for a premise that no code gives is refused when it judges.
    void premise(std::string name, bool met, std::string words) {
        premises.push_back({std::move(name), std::move(words), met});
    }
    /// For claims about a graphics chip's time.
    void premise_graphics_chip();
};

/// What one rule says of the evidence.
struct Judgement {
    const Rule* rule = nullptr;
    std::vector<Measure> measures = {};   ///< those that it asks for, with their bounds
    std::vector<std::string> unmet = {};  ///< why the figures do not speak about the claim
    std::string not_run = {};             ///< why there is nothing to judge

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

/// Throws std::logic_error where the rule asks for a figure or a premise by a name that the evidence does not have.
Judgement judge(const Rule& rule, const Evidence& evidence);

}  // namespace radiafit::harness
