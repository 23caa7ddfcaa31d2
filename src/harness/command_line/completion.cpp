#include "command_line/completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>

namespace radiafit::harness {
namespace {

/// each(command, path), " import colmap" of those below; the program itself first, with an empty path.
void for_commands(const CommandDescription& command,
                  const std::function<void(const CommandDescription&, const std::string&)>& each,
                  const std::string& path = "") {
    each(command, path);
    for (const CommandDescription& below : command.commands) for_commands(below, each, path + " " + below.name);
}

std::vector<std::string> option_names(const CommandDescription& command) {
    std::vector<std::string> out;
    for (const OptionDescription& o : command.options)
        if (!o.positional) out.insert(out.end(), o.names.begin(), o.names.end());
    return out;
}

/// Commands below, and values of positional arguments.
std::vector<std::string> words(const CommandDescription& command) {
    std::vector<std::string> out;
    for (const CommandDescription& below : command.commands) out.push_back(below.name);
    for (const OptionDescription& o : command.options)
        if (o.positional) out.insert(out.end(), o.choices.begin(), o.choices.end());
    return out;
}

/// In single quotes, as fish takes it.
std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'' || c == '\\') out += '\\';
        out += c == '\n' ? ' ' : c;
    }
    return out + "'";
}

}  // namespace

std::string bash_completion(const CommandDescription& program) {
    const std::string function = "_" + program.name;
    std::string paths, values, lists;
    for_commands(program, [&](const CommandDescription& command, const std::string& path) {
        if (!path.empty()) paths += fmt::format("{}\"{}\"", paths.empty() ? "" : " | ", path);
        // the program's options may come after a command
        std::vector<std::string> names = option_names(command);
        if (!path.empty())
            for (const std::string& name : option_names(program))
                if (name.starts_with("--") && name != "--help" && name != "--version") names.push_back(name);
        lists += fmt::format("        \"{}\")\n            options=\"{}\"\n            words=\"{}\"\n            ;;\n",
                             path, fmt::join(names, " "), fmt::join(words(command), " "));
        for (const OptionDescription& o : command.options) {
            if (o.positional || o.type.empty()) continue;
            std::vector<std::string> patterns;
            for (const std::string& name : o.names)
                patterns.push_back(path.empty() ? fmt::format("*\" {}\"", name) : fmt::format("\"{} {}\"", path, name));
            values += fmt::format("        {})\n            COMPREPLY=({})\n            return\n            ;;\n",
                                  fmt::join(patterns, " | "),
                                  o.choices.empty()
                                      ? ""
                                      : fmt::format("$(compgen -W \"{}\" -- \"$current\")", fmt::join(o.choices, " ")));
        }
    });
    return fmt::format(R"(# {0}'s completion for bash, made by: {0} completion bash
{1}() {{
    local current="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD - 1]}}" path="" word options="" words=""
    if [[ $current == = ]]; then
        current=""
    elif [[ $before == = ]]; then
        before="${{COMP_WORDS[COMP_CWORD - 2]}}"
    fi
    for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
        case "$path $word" in
        {2}) path="$path $word" ;;
        esac
    done
    # where nothing is found, bash goes on with the names of files
    case "$path $before" in
{3}    esac
    case "$path" in
{4}    esac
    if [[ $current == -* ]]; then
        words="$options"
    fi
    COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F {1} {0}
)",
                       program.name, function, paths, values, lists);
}

std::string zsh_completion(const CommandDescription& program) {
    return fmt::format("#compdef {}\nautoload -U +X bashcompinit && bashcompinit\n{}", program.name,
                       bash_completion(program));
}

std::string fish_completion(const CommandDescription& program) {
    std::string out = fmt::format("# {0}'s completion for fish, made by: {0} completion fish\n", program.name);
    for_commands(program, [&](const CommandDescription& command, const std::string& path) {
        const std::string condition =
            path.empty() ? "" : fmt::format(" -n '__fish_seen_subcommand_from {}'", command.name);
        const std::string below = path.empty() ? " -n __fish_use_subcommand" : condition;
        for (const CommandDescription& one : command.commands)
            out += fmt::format("complete -c {}{} -f -a {} -d {}\n", program.name, below, one.name, quoted(one.about));
        for (const OptionDescription& o : command.options) {
            const std::string values =
                o.choices.empty() ? "" : fmt::format(" -x -a {}", quoted(fmt::format("{}", fmt::join(o.choices, " "))));
            if (o.positional) {
                if (!values.empty()) out += fmt::format("complete -c {}{}{}\n", program.name, condition, values);
                continue;
            }
            std::string names;
            for (const std::string& name : o.names)
                names += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
            out += fmt::format("complete -c {}{}{}{}{} -d {}\n", program.name, condition, names,
                               o.type.empty() || !values.empty() ? "" : " -r", values, quoted(o.help));
        }
    });
    return out;
}

}  // namespace radiafit::harness
