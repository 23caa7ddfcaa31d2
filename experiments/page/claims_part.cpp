#include "claims_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "page/html_table.h"
#include "pieces.h"

namespace radiafit::harness {
namespace {

/// In the order of interest, and what each says.
constexpr std::array<std::pair<const char*, const char*>, 5> verdicts = {{
    {"holds", "the whole 95 % interval of every figure lies within what the rule asks for"},
    {"does not hold", "an interval lies wholly apart from it"},
    {"undecided",
     "an interval straddles the rule's bound or lies between what holds and what does not, or repetitions were too few "
     "for one"},
    {"not comparable", "the claim is about something that these runs are not of, such as a graphics chip's time"},
    {"not run", "no rows to judge from"},
}};

size_t rank(const std::string& verdict) {
    return size_t(std::ranges::find(verdicts, verdict, [](const auto& pair) { return pair.first; }) - verdicts.begin());
}

/// The figures that a verdict is of, so many at most.
Html measured(const Finding* finding) {
    constexpr size_t most = 2;
    if (!finding) return {};
    const auto& measures = finding->judgement.measures;
    Html list;
    for (size_t i = 0; i < std::min(most, measures.size()); ++i) {
        const Measure& m = measures[i];
        list << element("li", Html(m.of + ": ")
                                  << element("b", m.value_text()) << fmt::format(" ({})", m.interval_text()));
    }
    if (measures.size() > most)
        list << element("li",
                        link(fmt::format("#{}", finding->claim->id), fmt::format("{} more", measures.size() - most)));
    return list.empty() ? list : element("ul", {{"class", "figures"}}, list);
}

/// Verdicts by other runs than the one shown, machine by machine.
Html other_machines(const ClaimFindings& claim, const ClaimFindings::Line& shown) {
    Html list;
    size_t count = 0;
    for (const ClaimFindings::Line& line : claim.lines()) {
        if (line.judged == shown.judged || !line.judged) continue;
        list << element("li", verdict_mark(line.verdict()) << " " << element("small", line.renderer()));
        ++count;
    }
    if (count == 0) return {};
    return element("details",
                   element("summary", count == 1 ? "another machine" : fmt::format("{} other machines", count))
                       << element("ul", list));
}

HtmlRow row_of(const ClaimFindings& claim, size_t place, const ClaimFindings::Line& line) {
    const Finding* told = line.judged && !line.judged->judgement.measures.empty() ? line.judged : line.smaller;
    Html mark = verdict_mark(line.verdict());
    if (line.judged && !line.judged->run.empty()) mark << " " << element("small", line.renderer());
    if (const std::string others = line.by_other_rules(); !others.empty())
        mark << element("p", element("small", others));
    if (line.smaller && !line.smaller->run.empty())
        mark << element("p", element("small", "at smaller scale, by the rule: " + line.at_smaller_scale()));
    mark << other_machines(claim, line);
    Html figures = measured(told);
    if (told && !told->judged()) figures << element("small", fmt::format("{} profile", told->profile));
    const Finding* reasoned = line.judged ? line.judged : line.smaller;
    const auto label = [](const char* name, Attributes more = {}) {
        more.emplace_back("data-label", name);
        return more;
    };
    const std::string order = fmt::format("{:02}", place);
    return {{{link(fmt::format("#{}", claim.claim->id), claim.claim->id), {{"data-sort", order}}},
             {claim.claim->states, label("The paper states")},
             {claim.claim->section, label("Section")},
             {mark, label("Verdict", {{"data-sort", std::to_string(rank(line.verdict()))}})},
             {figures, label("Measured")},
             {reasoned ? reasoned->reason() : "", label("Why")}},
            {{"data-verdict", line.verdict()}}};
}

/// What another rule says of the same rows.
Html other_rule(const Finding& f, const Judgement& j) {
    Html head = Html(j.rule->until.empty() ? fmt::format("By the other reading, {}: ", j.rule->name)
                                           : fmt::format("By the rule until {}: ", j.rule->until));
    head << verdict_mark(f.verdict(j));
    if (const std::string reason = j.reason(); !reason.empty()) head << " " << reason << ".";
    Html part = element("p", head);
    if (!j.measures.empty())
        part << element("details", element("summary", "Its figures") << scroll_box(
                                       fmt::format("{}, by another rule", f.claim->id), html_table({}, j.table())));
    return part;
}

Html finding_part(const Finding& f) {
    const Judgement& j = f.judgement;
    const Evidence& e = f.evidence;
    Html about = verdict_mark(f.verdict());
    about << fmt::format(" {} profile", f.profile);
    if (!f.run.empty()) about << "; " << e.renderer << "; " << element("code", f.run);
    Html part = element("p", about);
    if (const std::string reason = f.reason(); !reason.empty())
        part << element("p", element("b", "Why: ") << reason << ".");
    if (const std::string run = f.decided_by(); !run.empty())
        part << element("p", element("b", "What decides it: ") << run << ".");
    if (!f.judged() && !f.run.empty())
        part << element("p", Html("By the rule alone: ") << verdict_mark(f.by_the_rule()));
    if (!e.sentence.empty()) part << element("p", e.sentence);
    if (!j.measures.empty()) part << scroll_box(fmt::format("{}, measured", f.claim->id), html_table({}, j.table()));
    for (const auto* others : {&f.readings, &f.former})
        for (const Judgement& other : *others) part << other_rule(f, other);
    if (f.rule_is_younger()) part << element("p", "These rows are older than the rule.");
    Html beside;
    for (const std::string& line : e.beside) beside << element("li", line);
    if (!beside.empty()) part << element("p", "Beside it:") << element("ul", beside);
    return element("div",
                   {{"class", "finding"},
                    {"data-claim", f.claim->id},
                    {"data-profile", f.profile},
                    {"data-run", f.run},
                    {"data-verdict", f.verdict()},
                    {"data-by-the-rule", f.by_the_rule()}},
                   part);
}

}  // namespace

Html claims_counts(std::span<const ClaimFindings> claims) {
    Html list;
    for (const auto& [verdict, meaning] : verdicts) {
        const auto count =
            std::ranges::count_if(claims, [&](const ClaimFindings& c) { return c.first().verdict() == verdict; });
        Html item = element("b", {{"class", "count"}}, std::to_string(count));
        item << " " << verdict_mark(verdict) << " " << element("small", meaning);
        list << element("li", item);
    }
    return element("ul", {{"class", "counts"}}, list);
}

Html claims_summary(std::span<const ClaimFindings> claims) {
    std::vector<HtmlRow> rows;
    for (size_t i = 0; i < claims.size(); ++i) {
        const auto lines = claims[i].lines();
        const Finding* best = &claims[i].first();
        const auto shown = std::ranges::find(lines, best, &ClaimFindings::Line::judged);
        rows.push_back(row_of(claims[i], i, shown == lines.end() ? lines.front() : *shown));
    }
    Html part;
    part << html_table(
        "Each claim, judged at the paper's scale; in brackets intervals of 95 %, \"counted\" where every run gives the "
        "same, \"too few repetitions\" where there are fewer than nine. Rules and reasons: the claim's link.",
        {"Claim", "The paper states", "Section", "Verdict", "Measured", "Why"}, rows, {},
        {{"class", "claims sortable"}, {"id", "claims-table"}});
    return part;
}

Html claims_in_full(std::span<const ClaimFindings> claims) {
    Html part;
    for (const ClaimFindings& found : claims) {
        const Claim& claim = *found.claim;
        Html article = element("h3", fmt::format("{}: {}", claim.id, claim.states));
        article << element("p", {{"class", "source"}},
                           Html(fmt::format("The paper, Section {}; judged from ", claim.section))
                               << link(fmt::format("#{}", claim.experiment), claim.experiment));
        article << element("p", element("b", fmt::format("Rule, since {}: ", claim.rule.since))
                                    << claim.rule.text << ".");
        article << element("p", element("b", "Why this one: ") << claim.rule.reason << ".");
        article << element("p", element("b", "Scale: ") << claim.rule.scale << ".");
        for (const Rule& rule : claim.readings)
            article << element("p", element("b", fmt::format("Another reading, {}: ", rule.name)) << rule.text << ".");
        for (const Rule& rule : claim.former)
            article << element("p", element("b", fmt::format("Until {}: ", rule.until))
                                        << rule.text << ". It changed because " << rule.changed << ".");
        for (const Finding& f : found.judged) article << finding_part(f);
        Html smaller;
        for (const Finding& f : found.smaller) smaller << finding_part(f);
        if (!smaller.empty())
            article << element("details", element("summary", fmt::format("{} profile", found.smaller.front().profile))
                                              << smaller);
        part << element("article", {{"class", "claim"}, {"id", claim.id}}, article);
    }
    return part;
}

Html claims_of(std::span<const ClaimFindings> claims, const std::string& experiment) {
    Html items;
    for (const ClaimFindings& found : claims) {
        const Claim& claim = *found.claim;
        if (experiment != claim.experiment) continue;
        items << element("li", link(fmt::format("#{}", claim.id), claim.id)
                                   << " " << verdict_mark(found.first().verdict()) << " " << claim.states);
    }
    return items.empty() ? items : element("ul", {{"class", "judged"}}, items);
}

}  // namespace radiafit::harness
