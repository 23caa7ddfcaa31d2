// options: the reference page of a fit's options, made from their table; and the manual page of all commands.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "base/record.h"
#include "cli/commands.h"
#include "command_line/man_page.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"

namespace radiafit::tools {
namespace {

/// Whether a fit of the family by this solver does, or one of any family.
bool takes(const Family& family, const Solver& solver, const FitOption& option) {
    const uint32_t uses = family.uses(solver);
    return uses != 0 && option.means_something(family, uses);
}
bool any_takes(const Solver& solver, const FitOption& option) {
    return std::ranges::any_of(families(), [&](const Family* family) { return takes(*family, solver, option); });
}

/// "two-step, ceres; engine fragment", or "every fit".
std::string takers(const FitOption& option) {
    if (option.uses == 0 && option.families.empty()) return "every fit";
    std::vector<std::string> all;
    for (const EngineKind engine : {EngineKind::cpu, EngineKind::fragment, EngineKind::compute})
        if (engine_uses(engine) & option.uses) {
            FitRequest request;
            request.engine = engine;
            all.push_back("engine " + request.text("engine"));
        }
    std::vector<std::string> of_all, of_one;
    bool alike = true;  // each solver takes it of every family that it fits
    for (const Family* family : families()) {
        std::vector<std::string> names;
        for (const Solver& solver : solvers()) {
            const uint32_t uses = family->uses(solver);
            const bool it_takes = takes(*family, solver, option);
            if (it_takes) names.emplace_back(solver.name);
            if (it_takes && std::ranges::find(of_all, solver.name) == of_all.end()) of_all.emplace_back(solver.name);
            alike = alike && (it_takes || !uses || !any_takes(solver, option));
        }
        if (!names.empty()) of_one.push_back(fmt::format("{}: {}", family->name, fmt::join(names, ", ")));
    }
    if (alike)
        all.insert(all.end(), of_all.begin(), of_all.end());
    else
        all.push_back(fmt::format("{}", fmt::join(of_one, "; ")));
    for (const Method& method : methods) {
        FitRequest request;
        request.optimizer = &method;
        if (uses_of(request) & ~uses_of(FitRequest()) & option.uses)
            all.push_back("optimizer " + std::string(method.name));
    }
    return fmt::format("{}", fmt::join(all, ", "));
}

/// Text as it stands in a cell of a Markdown table.
std::string cell(std::string text) {
    for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
    return text;
}

void print_options() {
    fmt::print(
        "# Options of `radiafit fit` and `radiafit plan`\n\nMade by `radiafit options`; a test compares. An option "
        "that means nothing to the chosen fit is refused. The same names, with underscores, stand in fit.json and "
        "in experiments' configs.\n");
    const FitRequest defaults;
    std::string group;
    for (const FitOption& o : fit_options()) {
        if (o.group != group)
            fmt::print("\n## {}\n\n| option | values | default | what it is | of |\n|---|---|---|---|---|\n", o.group);
        group = o.group;
        const std::string value = o.hide_default ? "" : o.text(defaults);
        fmt::print("| `{}` | {} | {} | {} | {} |\n", cell(o.flag.substr(0, o.flag.find(','))), cell(o.values),
                   value.empty() ? "" : "`" + cell(value) + "`", cell(o.help), takers(o));
    }
}

}  // namespace

void add_options(CommandLine& program) {
    auto man = std::make_shared<bool>(false);
    CommandLine& command = program.add_command("options", "every option of fit and plan, as a Markdown page");
    command.add_flag("--man", *man, "every command, as a manual page: radiafit options --man | man -l -");
    command.on_run([man, &program] {
        if (*man)
            fmt::print("{}", man_page(program.describe(), project_version()));
        else
            print_options();
    });
}

}  // namespace radiafit::tools
