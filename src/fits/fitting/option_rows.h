#pragma once
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <concepts>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/choose.h"
#include "base/range.h"
#include "fitting/fit_options.h"

/// Rows of the table of a fit's options. `member` is a member of FitRequest, or a function that finds one in it: in()
/// finds members of members, own() those of the options of a single family.
namespace radiafit::fits::rows {

/// As JSON; names may be no UTF-8.
std::string dumped(const std::string& value);
std::string dumped(double value);
template <std::integral Number>
std::string dumped(Number value) {
    return fmt::format("{}", value);
}

/// "surface_side" as --surface-side, without values yet.
FitOption option(const char* name, Meaning meaning, const char* help);

/// in(&FitRequest::model, &LfmOptions::terms) is model.terms.
template <class... Members>
auto in(Members... members) {
    return [=](auto& r) -> auto& { return (r.*....*members); };
}
/// A member of the options of a single family, such as own(&ViewBasisOptions::rank).
template <class Block, class Value>
auto own(Value Block::*member) {
    return [member](auto& r) -> auto& { return r.template own<Block>().*member; };
}

/// One of several names. `what` is what messages call it.
template <class Choice, class Member>
FitOption choice(const char* name, Meaning meaning, Member member, std::vector<std::pair<std::string, Choice>> choices,
                 const char* help, const char* what = nullptr) {
    FitOption o = option(name, std::move(meaning), help);
    for (const auto& c : choices) o.choices.push_back(c.first);
    o.type = "NAME";
    o.values = fmt::format("{}", fmt::join(o.choices, ", "));
    o.read = [member, choices, what = std::string(what ? what : name)](FitRequest& r, const std::string& text) {
        std::invoke(member, r) = choose(what, text, choices);
    };
    o.text = [member, choices](const FitRequest& r) {
        const auto found = std::ranges::find(choices, std::invoke(member, r), &std::pair<std::string, Choice>::second);
        return found->first;
    };
    o.json = [text = o.text](const FitRequest& r) { return dumped(text(r)); };
    return o;
}

template <class Member, class Number>
FitOption number(const char* name, Meaning meaning, Member member, const Range<Number>& range, const char* help,
                 const char* flag = nullptr) {
    FitOption o = option(name, std::move(meaning), help);
    if (flag) o.flag = flag;
    const std::string plain = o.flag.substr(2);
    o.type = std::is_integral_v<Number> ? "INT" : "FLOAT";
    o.values = advice(range).substr(std::string("choose ").size());
    o.read = [member, range, plain](FitRequest& r, const std::string& text) {
        using T = std::remove_cvref_t<decltype(std::invoke(member, r))>;
        std::invoke(member, r) = static_cast<T>(parse_number(plain, text, range));
    };
    o.text = [member](const FitRequest& r) { return fmt::format("{}", std::invoke(member, r)); };
    o.json = [member](const FitRequest& r) { return dumped(std::invoke(member, r)); };
    o.check = [member, range, plain](const FitRequest& r) { require(plain, Number(std::invoke(member, r)), range); };
    return o;
}

/// Any text; `valid` may throw UserError.
template <class Member>
FitOption text(const char* name, Meaning meaning, Member member, const char* values, std::string help,
               void (*valid)(const std::string&) = nullptr) {
    FitOption o = option(name, std::move(meaning), "");
    o.help = std::move(help);
    o.values = values;
    o.read = [member, valid](FitRequest& r, const std::string& value) {
        if (valid) valid(value);
        std::invoke(member, r) = value;
    };
    if (valid) o.check = [member, valid](const FitRequest& r) { valid(std::invoke(member, r)); };
    o.text = [member](const FitRequest& r) { return std::invoke(member, r); };
    o.json = [member](const FitRequest& r) { return dumped(std::invoke(member, r)); };
    return o;
}

FitOption flag(const char* name, Meaning meaning, bool FitRequest::*member, const char* flag, const char* help);

/// An option whose default a command line takes from the dataset (fitting/resolve_options.h), as its help says.
FitOption by_data(FitOption option);
FitOption of_problem(FitOption option);
FitOption of_resources(FitOption option);

}  // namespace radiafit::fits::rows
