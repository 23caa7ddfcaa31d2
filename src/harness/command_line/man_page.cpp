#include "command_line/man_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace radiafit::harness {
namespace {

/// Text that roff sets as it is.
std::string escaped(const std::string& text) {
    std::string out;
    if (text.starts_with('.') || text.starts_with('\'')) out = "\\&";
    for (const char c : text) {
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else
            out += c == '\n' ? ' ' : c;
    }
    return out;
}

std::string upper(std::string text) {
    std::ranges::transform(text, text.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 32) : c; });
    return text;
}

/// "\fB\-o\fR, \fB\-\-output\fR \fITEXT\fR".
std::string heading(const OptionDescription& o) {
    std::vector<std::string> names;
    for (const std::string& name : o.names)
        names.push_back(
            fmt::format("\\f{}{}\\fR", o.positional ? 'I' : 'B', escaped(o.positional ? upper(name) : name)));
    std::string out = fmt::format("{}", fmt::join(names, ", "));
    if (!o.positional && !o.type.empty()) out += fmt::format(" \\fI{}\\fR", escaped(o.type));
    return out;
}

std::string text_of(const OptionDescription& o) {
    std::string out = escaped(o.help);
    if (!o.choices.empty()) out += escaped(fmt::format("; one of {}", fmt::join(o.choices, ", ")));
    if (!o.default_text.empty() && !o.type.empty()) out += escaped(fmt::format(" (default: {})", o.default_text));
    return out;
}

void add_options(std::string& out, const CommandDescription& command) {
    std::string group;
    for (const OptionDescription& o : command.options) {
        if (o.group != group && !o.group.empty()) out += fmt::format(".PP\n\\fI{}\\fR\n", escaped(o.group));
        group = o.group;
        out += fmt::format(".TP\n{}\n{}\n", heading(o), text_of(o));
    }
}

/// A command, or those below it. `before`: "radiafit import".
void add_command(std::string& out, const CommandDescription& command, const std::string& before) {
    const std::string name = before + " " + command.name;
    out += fmt::format(".SS {}\n{}.\n", escaped(name), escaped(command.about));
    if (command.commands.empty()) {
        std::string arguments;
        for (const OptionDescription& o : command.options)
            if (o.positional) arguments += fmt::format(" \\fI{}\\fR", escaped(upper(o.names.front())));
        out += fmt::format(".PP\n\\fB{}\\fR{} [\\fIOPTIONS\\fR]\n", escaped(name), arguments);
        add_options(out, command);
    }
    for (const CommandDescription& below : command.commands) add_command(out, below, name);
}

constexpr const char* rest = R"(.SH EXIT STATUS
.TP
0
Done, and everything that was asked for is there.
.TP
1
The machine failed, or \fBcompare\fR found a difference.
.TP
2
The user can correct it: one line on standard error names the file or option, and the cure.
.TP
130, 143
Stopped by SIGINT (Ctrl\-C) or SIGTERM, after the current step; a second signal ends the program at once.
.SH ENVIRONMENT
.TP
\fBNO_COLOR\fR
If set and not empty: no colours, which terminals alone are given.
.SH FILES
.TP
\fIOUTPUT\fR.parts
What a fit that was stopped has finished; the same command goes on from there.
.TP
\fIOUTPUT\fR/.radiafit\-made.json
Which command made the folder, by which the same command knows that it is done.
)";

}  // namespace

std::string man_page(const CommandDescription& program, const std::string& version) {
    std::string out = fmt::format(".TH {} 1 \"\" \"{} {}\" \"User Commands\"\n", upper(program.name),
                                  escaped(program.name), escaped(version));
    out += fmt::format(".SH NAME\n{} \\- {}\n", escaped(program.name),
                       escaped("fits image-based models to posed photographs"));
    out += fmt::format(".SH SYNOPSIS\n\\fB{}\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n{}\n.SH OPTIONS\n",
                       escaped(program.name), escaped(program.about));
    add_options(out, program);
    out += ".SH COMMANDS\n";
    for (const CommandDescription& command : program.commands) add_command(out, command, program.name);
    return out + rest;
}

}  // namespace radiafit::harness
