#pragma once
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/range.h"

/// Options of the command line that are checked by their rule as they are read.
namespace radiafit {

/// "--surface-side" is "surface-side" in messages.
inline std::string plain_name(const std::string& option) { return option.substr(option.find_first_not_of('-')); }

/// A number. `value` may have a narrower type than the range, or be optional.
template <class T, class Number>
CLI::Option* add_number(CLI::App& command, const std::string& name, T& value, const Range<Number>& range,
                        const std::string& help) {
    CLI::Option* option = command.add_option_function<std::string>(
        name,
        [&value, range, plain = plain_name(name)](const std::string& text) {
            value = static_cast<T>(parse_number(plain, text, range));
        },
        help);
    option->type_name(std::is_integral_v<Number> ? "INT" : "FLOAT");
    if constexpr (std::is_arithmetic_v<T>) option->default_str(fmt::format("{}", value));
    return option;
}

/// A file, a folder or another text that says nothing if it is empty.
template <class Text>
CLI::Option* add_text(CLI::App& command, const std::string& name, Text& value, const std::string& help) {
    CLI::Option* option = command.add_option_function<std::string>(
        name,
        [&value, plain = plain_name(name.substr(name.find(',') + 1))](const std::string& text) {
            if (text.empty()) throw UserError(fmt::format("{} = '': give a name", plain));
            value = text;
        },
        help);
    option->type_name("TEXT");
    if (!value.empty()) option->default_str(value);
    return option;
}

/// Throws UserError: NAME is not among `names`, which it tells.
[[noreturn]] void reject_name(const std::string& what, const std::string& name, const std::vector<std::string>& names);

/// The choice that has this name. Throws UserError, telling the names that there are.
template <class Choice>
Choice choose(const std::string& what, const std::string& name,
              const std::vector<std::pair<std::string, Choice>>& choices) {
    std::vector<std::string> names;
    for (const auto& [known, choice] : choices) {
        if (known == name) return choice;
        names.push_back(known);
    }
    reject_name(what, name, names);
}

/// A name that stands for something.
template <class Choice>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Choice& value,
                        std::vector<std::pair<std::string, Choice>> choices, const std::string& help) {
    return command
        .add_option_function<std::string>(
            name,
            [&value, choices = std::move(choices), plain = plain_name(name)](const std::string& text) {
                value = choose(plain, text, choices);
            },
            help)
        ->type_name("NAME");
}

}  // namespace radiafit
