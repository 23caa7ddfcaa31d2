#include "app/parse_error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "base/config.h"

namespace radiafit {
namespace {

/// The command that was reached, a subcommand's subcommand at last.
const CLI::App& reached(const CLI::App& app) {
    const auto chosen = app.get_subcommands();
    return chosen.empty() ? app : reached(*chosen.front());
}

std::vector<std::string> commands_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return names;
}

/// Of a command and of all that it stands below.
std::vector<std::string> options_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* at = &app; at; at = at->get_parent())
        for (const CLI::Option* option : at->get_options())
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

}  // namespace

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& command = reached(app);
    const std::vector<std::string> rest = app.remaining(true), commands = commands_of(command);
    const std::string unknown = rest.empty() ? "" : rest.front();
    const std::string help = fmt::format("see {} --help", app.get_name());
    if (unknown.starts_with("-"))
        return fmt::format("option '{}' does not exist; the nearest is {}; {}", unknown,
                           nearest(unknown.substr(0, unknown.find('=')), options_of(command)), help);
    if (!unknown.empty() && !commands.empty())
        return fmt::format("command '{}' does not exist; choose one of {} (nearest: {}); {}", unknown,
                           fmt::join(commands, ", "), nearest(unknown, commands), help);
    if (!unknown.empty()) return fmt::format("'{}' is one argument too many; leave it out, or {}", unknown, help);
    return fmt::format("{}; {}", error.what(), help);
}

}  // namespace radiafit
