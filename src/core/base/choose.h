#pragma once
#include <string>
#include <utility>
#include <vector>

/// Choices by name.
namespace radiafit {

/// Throws UserError: NAME is not among `names`, which the message lists.
[[noreturn]] void reject_name(const std::string& what, const std::string& name, const std::vector<std::string>& names);

/// The choice that has this name. Throws UserError that lists the names there are.
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

/// A choice's name, "" of none of them.
template <class Choice>
std::string name_of_choice(const std::vector<std::pair<std::string, Choice>>& choices, const Choice& wanted) {
    for (const auto& [name, choice] : choices)
        if (choice == wanted) return name;
    return "";
}

}  // namespace radiafit
