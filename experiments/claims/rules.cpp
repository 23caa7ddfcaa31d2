#include "rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "base/toml.h"
#include "rules_text.h"

namespace radiafit::harness {
namespace {

using Json = nlohmann::json;

/// A table of rules.toml, of which every entry has to be asked for.
class Entries {
public:
    Entries(const Json& table, std::string where) : table_(table), where_(std::move(where)) {
        if (!table_.is_object()) fail("is no table");
    }

    std::string text(const char* key) {
        const Json* value = take(key);
        if (value && !value->is_string()) fail(fmt::format("'{}' is no text", key));
        return value ? value->get<std::string>() : "";
    }
    std::string needed(const char* key) {
        std::string value = text(key);
        if (value.empty()) fail(fmt::format("lacks '{}'", key));
        return value;
    }
    std::optional<double> number(const std::string& key) {
        const Json* value = take(key);
        if (value && !value->is_number()) fail(fmt::format("'{}' is no number", key));
        return value ? std::optional(value->get<double>()) : std::nullopt;
    }
    /// Empty where there is none.
    Json list(const std::string& key) {
        const Json* value = take(key);
        if (value && !value->is_array()) fail(fmt::format("'{}' is no list", key));
        return value ? *value : Json::array();
    }
    void finish() const {
        for (const auto& [key, value] : table_.items())
            if (!std::ranges::count(taken_, key)) fail(fmt::format("unknown '{}'", key));
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw std::logic_error(fmt::format("rules.toml: {}: {}", where_, what));
    }

private:
    const Json* take(const std::string& key) {
        taken_.push_back(key);
        const auto found = table_.find(key);
        return found == table_.end() ? nullptr : &*found;
    }
    const Json& table_;
    std::string where_;
    std::vector<std::string> taken_;
};

/// "at_least", "at_most" or "between", behind a prefix.
std::optional<Bound> read_bound(Entries& entries, const std::string& prefix) {
    const Json ends = entries.list(prefix + "between");
    const auto least = entries.number(prefix + "at_least"), most = entries.number(prefix + "at_most");
    if (ends.size() == 2) return Bound{ends[0].get<double>(), ends[1].get<double>()};
    if (!ends.empty()) entries.fail("'between' takes two numbers");
    if (!least && !most) return {};
    return Bound{least.value_or(-HUGE_VAL), most.value_or(HUGE_VAL)};
}

/// What rules of every kind have.
Rule read_rule(Entries& entries, const std::string& where) {
    Rule rule;
    rule.text = entries.needed("rule");
    rule.computed = entries.text("computed");
    rule.none = entries.text("none");
    rule.premises = entries.list("premises").get<std::vector<std::string>>();
    for (const Json& table : entries.list("asks")) {
        Entries one(table, where + ", asks");
        Rule::Asked asked{.of = one.needed("of")};
        const auto bound = read_bound(one, "");
        if (!bound && rule.none.empty()) one.fail("has no bound");
        asked.bound = bound.value_or(Bound());
        asked.failing = read_bound(one, "fails_");
        one.finish();
        rule.asked.push_back(std::move(asked));
    }
    if (rule.asked.empty() && rule.none.empty()) entries.fail("asks for nothing");
    return rule;
}

Claim read_claim(const std::string& id, const Json& table) {
    Entries entries(table, id);
    Claim claim{.id = id,
                .section = entries.needed("section"),
                .states = entries.needed("states"),
                .experiment = entries.needed("experiment"),
                .rule = read_rule(entries, id),
                .find = nullptr};
    claim.rule.since = entries.needed("since");
    claim.rule.reason = entries.needed("reason");
    claim.rule.scale = entries.needed("scale");
    const auto others = [&](const char* key, std::vector<Rule>& to, const auto& more) {
        for (const Json& other : entries.list(key)) {
            const std::string where = fmt::format("{}, {}", id, key);
            Entries one(other, where);
            Rule rule = read_rule(one, where);
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
    std::vector<ClaimCode> code;
    for (const auto topic : {convergence_claims(), stopping_claims(), samples_claims(), images_claims(), time_claims(),
                             utilization_claims(), scale_claims()})
        code.insert(code.end(), topic.begin(), topic.end());
    const Json rules = Json::parse(json_of_toml(rules_text));
    std::vector<Claim> claims;
    for (const auto& [id, table] : rules.items()) {
        claims.push_back(read_claim(id, table));
        const auto found = std::ranges::find(code, id, [](const ClaimCode& c) { return std::string(c.id); });
        if (found == code.end()) throw std::logic_error("rules.toml: no code for " + id);
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
