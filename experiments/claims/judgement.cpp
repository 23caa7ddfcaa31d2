#include "judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "gl/context.h"

namespace radiafit::harness {
namespace {

constexpr size_t least_seeds = 3;

std::string number_text(double value, const std::string& unit) {
    const double shown = unit == "%" || unit == "percentage points" ? 100 * value : value;
    if (shown == 0) return "0";
    const double size = std::abs(shown);
    return size >= 1000  ? fmt::format("{:.0f}", shown)
           : size < 1e-3 ? fmt::format("{:.1e}", shown)
                         : fmt::format("{:.3g}", shown);
}

std::string with_unit(const std::string& text, const std::string& unit) {
    return unit.empty() ? text : text + " " + unit;
}

bool within(const Interval& i, const Bound& b) { return i.low >= b.least && i.high <= b.most; }
bool apart(const Interval& i, const Bound& b) { return i.high < b.least || i.low > b.most; }

nlohmann::ordered_json number_or_null(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

}  // namespace

Figure exact(double value) { return {value, Interval{value, value}}; }

Figure median_of_rounds(const std::vector<double>& values) {
    Figure figure{median(values)};
    if (values.size() >= least_rounds) figure.interval = median_interval(values, values.size());
    return figure;
}

Figure median_of_problems(const std::vector<double>& values, size_t independent) {
    return {median(values), median_interval(values, independent)};
}

Figure share_of(double share, size_t independent) { return {share, share_interval(share, independent)}; }

Figure mean_of_seeds(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    Figure figure{sum / double(values.size())};
    if (values.size() >= least_seeds) figure.interval = mean_interval(values);
    return figure;
}

std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

std::string with_interval(const Figure& figure) {
    const std::string value = fmt::format("{:.3g}", figure.value);
    if (!figure.interval) return value;
    if (figure.interval->high == HUGE_VAL) return fmt::format("{} ({:.3g} or more)", value, figure.interval->low);
    return fmt::format("{} ({:.3g} to {:.3g})", value, figure.interval->low, figure.interval->high);
}

std::string Bound::text(const std::string& unit) const {
    if (least == -HUGE_VAL && most == HUGE_VAL) return "";
    if (least == most) return with_unit(number_text(least, unit), unit);
    if (most == HUGE_VAL) return "at least " + with_unit(number_text(least, unit), unit);
    if (least == -HUGE_VAL) return "at most " + with_unit(number_text(most, unit), unit);
    return with_unit(number_text(least, unit) + " to " + number_text(most, unit), unit);
}

const char* to_string(Outcome outcome) {
    switch (outcome) {
        case Outcome::holds:
            return "holds";
        case Outcome::fails:
            return "does not hold";
        case Outcome::undecided:
            break;
    }
    return "undecided";
}

Outcome Measure::outcome() const {
    if (!figure.interval || !std::isfinite(figure.value)) return Outcome::undecided;
    if (within(*figure.interval, bound)) return Outcome::holds;
    if (failing ? within(*figure.interval, *failing) : apart(*figure.interval, bound)) return Outcome::fails;
    return Outcome::undecided;
}

const char* Measure::why_undecided() const {
    if (!figure.interval) return "too few repetitions for an interval";
    if (failing && apart(*figure.interval, bound) && apart(*figure.interval, *failing))
        return "the interval lies between what holds and what does not";
    return "the interval straddles the bound";
}

std::string Measure::value_text() const { return with_unit(number_text(figure.value, unit), unit); }

std::string Measure::interval_text() const {
    if (!figure.interval) return "too few repetitions";
    const auto [low, high] = *figure.interval;
    if (low == high) return "counted";
    if (high == HUGE_VAL) return with_unit(number_text(low, unit), unit) + " or more";
    return with_unit(number_text(low, unit) + " to " + number_text(high, unit), unit);
}

void Evidence::premise_graphics_chip() {
    premise("graphics chip", !is_software_renderer(renderer),
            "a graphics chip's time, and this renderer is the CPU itself");
}

Judgement judge(const Rule& rule, const Evidence& evidence) {
    Judgement j{.rule = &rule, .not_run = evidence.not_run};
    if (!j.not_run.empty()) return j;
    for (const std::string& name : rule.premises) {
        bool known = false;
        for (const Premise& p : evidence.premises) {
            if (p.name != name) continue;
            known = true;
            if (!p.met) j.unmet.push_back(p.words);
        }
        if (!known) throw std::logic_error(fmt::format("no premise '{}'", name));
    }
    for (const Rule::Asked& asked : rule.asked) {
        const size_t before = j.measures.size();
        for (const Measure& m : evidence.measures) {
            if (m.name != asked.of) continue;
            j.measures.push_back(m);
            j.measures.back().bound = asked.bound;
            j.measures.back().failing = asked.failing;
        }
        if (j.measures.size() == before && j.unmet.empty())
            throw std::logic_error(fmt::format("no figure '{}'", asked.of));
    }
    if (rule.asked.empty()) j.measures = evidence.measures;
    return j;
}

Outcome Judgement::outcome() const {
    bool undecided = measures.empty();
    for (const Measure& m : measures) {
        if (m.outcome() == Outcome::fails) return Outcome::fails;
        undecided = undecided || m.outcome() == Outcome::undecided;
    }
    return undecided ? Outcome::undecided : Outcome::holds;
}

std::string Judgement::verdict() const {
    if (!not_run.empty()) return "not run";
    if (!unmet.empty() || !rule->none.empty()) return "not comparable";
    return to_string(outcome());
}

std::string Judgement::reason() const {
    if (!not_run.empty()) return not_run;
    if (!rule->none.empty()) return rule->none;
    if (!unmet.empty()) return fmt::format("the claim is about {}", fmt::join(unmet, "; and about "));
    if (outcome() != Outcome::undecided) return "";
    for (const Measure& m : measures)
        if (m.outcome() == Outcome::undecided) return m.why_undecided();
    return "";
}

nlohmann::ordered_json Judgement::json() const {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Measure& m : measures) {
        nlohmann::ordered_json one = {{"of", m.of}, {"value", number_or_null(m.figure.value)}};
        if (m.figure.interval) one["interval"] = {m.figure.interval->low, number_or_null(m.figure.interval->high)};
        one["asked"] = {number_or_null(m.bound.least), number_or_null(m.bound.most)};
        if (m.failing) one["failing"] = {number_or_null(m.failing->least), number_or_null(m.failing->most)};
        one["outcome"] = rule->none.empty() ? to_string(m.outcome()) : "told";
        list.push_back(one);
    }
    return list;
}

Table Judgement::table() const {
    Table table({"measured", "value", "95 % interval", "asked for", "so it"});
    for (const Measure& m : measures)
        table.add({m.of, m.value_text(), m.interval_text(), rule->none.empty() ? m.bound.text(m.unit) : "",
                   rule->none.empty() ? to_string(m.outcome()) : ""});
    return table;
}

}  // namespace radiafit::harness
