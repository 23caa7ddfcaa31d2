#include "rules.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "rules_text.h"

namespace radiafit::harness {
namespace {

std::string date_text(const toml::date& d) { return fmt::format("{:04}-{:02}-{:02}", d.year, d.month, d.day); }

/// A table of rules.toml, of which every entry has to be asked for.
class Entries {
public:
    Entries(const toml::table& table, std::string where) : table_(table), where_(std::move(where)) {}
    ~Entries() = default;

    std::string text(const char* key) {
        const toml::node* node = take(key);
        if (!node) return "";
        if (const auto day = node->value<toml::date>()) return date_text(*day);
        const auto value = node->value<std::string>();
        if (!value) fail(fmt::format("'{}' is no text", key));
        return *value;
    }
    std::string needed(const char* key) {
        std::string value = text(key);
        if (value.empty()) fail(fmt::format("lacks '{}'", key));
        return value;
    }
    const toml::array* array(const char* key) {
        const toml::node* node = take(key);
        if (node && !node->is_array()) fail(fmt::format("'{}' is no list", key));
        return node ? node->as_array() : nullptr;
    }
    void finish() const {
        for (const auto& [key, node] : table_)
            if (std::ranges::find(taken_, std::string(key)) == taken_.end())
                fail(fmt::format("unknown '{}'", std::string(key)));
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw std::logic_error(fmt::format("rules.toml: {}: {}", where_, what));
    }

private:
    const toml::node* take(const char* key) {
        taken_.emplace_back(key);
        return table_.get(key);
    }
    const toml::table& table_;
    std::string where_;
    std::vector<std::string> taken_;
};

/// "at_least", "at_most" or "between", behind a prefix.
std::optional<Bound> read_bound(const toml::table& t, const std::string& prefix, const Entries& where) {
    const auto number = [&](const char* key) { return t[prefix + key].value<double>(); };
    if (const toml::array* ends = t[prefix + "between"].as_array()) {
        if (ends->size() != 2) where.fail("'between' takes two numbers");
        return Bound{(*ends)[0].value<double>().value(), (*ends)[1].value<double>().value()};
    }
    const auto least = number("at_least"), most = number("at_most");
    if (!least && !most) return {};
    return Bound{least.value_or(-HUGE_VAL), most.value_or(HUGE_VAL)};
}

/// What rules of every kind have.
Rule read_rule(Entries& entries) {
    Rule rule;
    rule.text = entries.needed("rule");
    rule.none = entries.text("none");
    if (const toml::array* premises = entries.array("premises"))
        for (const toml::node& premise : *premises) rule.premises.push_back(premise.value<std::string>().value());
    const toml::array* asks = entries.array("asks");
    if (!asks) entries.fail("lacks 'asks'");
    for (const toml::node& node : *asks) {
        const toml::table* t = node.as_table();
        if (!t || !(*t)["of"].is_string()) entries.fail("an entry of 'asks' names no figure");
        const auto bound = read_bound(*t, "", entries);
        if (!bound && rule.none.empty()) entries.fail("an entry of 'asks' has no bound");
        rule.asked.push_back(
            {*(*t)["of"].value<std::string>(), bound.value_or(Bound()), read_bound(*t, "fails_", entries)});
    }
    if (rule.asked.empty() && rule.none.empty()) entries.fail("asks for nothing");
    return rule;
}

const toml::table& table_of(const toml::node& node, const Entries& where) {
    if (!node.is_table()) where.fail("is no table");
    return *node.as_table();
}

Claim read_claim(const std::string& id, const toml::table& table) {
    Entries entries(table, id);
    Claim claim{.id = id,
                .section = entries.needed("section"),
                .states = entries.needed("states"),
                .experiment = entries.needed("experiment"),
                .rule = read_rule(entries),
                .find = nullptr};
    claim.rule.since = entries.needed("since");
    claim.rule.reason = entries.needed("reason");
    claim.rule.scale = entries.needed("scale");
    const auto others = [&](const char* key, std::vector<Rule>& to, const auto& more) {
        const toml::array* list = entries.array(key);
        for (size_t i = 0; list && i < list->size(); ++i) {
            Entries one(table_of((*list)[i], entries), fmt::format("{}, {}", id, key));
            Rule rule = read_rule(one);
            more(one, rule);
            one.finish();
            to.push_back(std::move(rule));
        }
    };
    others("readings", claim.readings, [](Entries& one, Rule& rule) { rule.name = one.needed("name"); });
    others("former", claim.former, [](Entries& one, Rule& rule) {
        rule.until = one.needed("until");
        rule.changed = one.needed("changed");
    });
    entries.finish();
    return claim;
}

std::vector<Claim> read_claims() {
    const toml::table all = toml::parse(rules_text);
    std::vector<ClaimCode> code;
    for (const auto topic :
         {convergence_claims(), images_claims(), time_claims(), utilization_claims(), scale_claims()})
        code.insert(code.end(), topic.begin(), topic.end());
    std::vector<Claim> claims;
    for (const auto& [id, node] : all) {
        claims.push_back(read_claim(std::string(id), table_of(node, Entries(all, std::string(id)))));
        const auto found =
            std::ranges::find(code, claims.back().id, [](const ClaimCode& c) { return std::string(c.id); });
        if (found == code.end()) throw std::logic_error("rules.toml: no code for " + claims.back().id);
        claims.back().find = found->find;
    }
    if (claims.size() != code.size()) throw std::logic_error("rules.toml: a claim has no rule");
    std::ranges::sort(claims, {}, [](const Claim& claim) { return std::atoi(claim.id.c_str() + 1); });
    return claims;
}

}  // namespace

const std::vector<Claim>& claims() {
    static const std::vector<Claim> all = read_claims();
    return all;
}

}  // namespace radiafit::harness
