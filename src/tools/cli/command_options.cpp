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
#include "fitting/solvers/solver.h"

namespace radiafit::tools {
namespace {

/// Whether the option means something to a fit of the family by this solver, on this engine or whatever the engine.
bool takes(const Family& family, const Solver& solver, const FitOption& option, std::optional<EngineKind> engine = {}) {
    if (!family.facts(solver)) return false;
    FitRequest request;
    request.set("model", family.models().front()).set("solver", solver.name);
    FitFacts fit = facts_of(request);
    fit.engine = engine;
    for (const Method* method : {request.optimizer, static_cast<const Method*>(nullptr)})
        for (const SampleUse samples : {SampleUse::cached, SampleUse::redistributed}) {
            fit.method = method;
            fit.samples = samples;
            if (option.means_something(fit)) return true;
        }
    return false;
}
bool any_takes(const Solver& solver, const FitOption& option) {
    return std::ranges::any_of(families(), [&](const Family* family) { return takes(*family, solver, option); });
}
/// Whether the engine is why it means something to some fit.
bool by_engine(const FitOption& option, EngineKind engine) {
    for (const Family* family : families())
        for (const Solver& solver : solvers()) {
            const auto facts = family->facts(solver);
            if (facts && facts->on_engine && takes(*family, solver, option, engine) && !takes(*family, solver, option))
                return true;
        }
    return false;
}

/// "two-step, ceres; engine fragment", or "every fit".
std::string takers(const FitOption& option) {
    if (!option.meaning && option.families.empty()) return "every fit";
    std::vector<std::string> all;
    for (const EngineKind engine : {EngineKind::cpu, EngineKind::fragment, EngineKind::compute})
        if (by_engine(option, engine)) {
            FitRequest request;
            request.engine = engine;
            all.push_back("engine " + request.text("engine"));
        }
    std::vector<std::string> of_all, of_one;
    bool alike = true;  // each solver takes it of every family that it fits
    for (const Family* family : families()) {
        std::vector<std::string> names;
        for (const Solver& solver : solvers()) {
            const bool it_takes = takes(*family, solver, option);
            if (it_takes) names.emplace_back(solver.name);
            if (it_takes && std::ranges::find(of_all, solver.name) == of_all.end()) of_all.emplace_back(solver.name);
            alike = alike && (it_takes || !family->facts(solver) || !any_takes(solver, option));
        }
        if (!names.empty()) of_one.push_back(fmt::format("{}: {}", family->name, fmt::join(names, ", ")));
    }
    if (alike)
        all.insert(all.end(), of_all.begin(), of_all.end());
    else
        all.push_back(fmt::format("{}", fmt::join(of_one, "; ")));
    FitFacts fit = facts_of(FitRequest());
    for (const Method& method : methods) {
        fit.method = &method;
        if (option.means_something(fit) && !option.means_something(facts_of(FitRequest())))
            all.push_back("optimizer " + std::string(method.name));
    }
    return fmt::format("{}", fmt::join(all, ", "));
}

/// Text as it is written in a cell of a Markdown table.
std::string cell(std::string text) {
    for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
    return text;
}

void print_options() {
    fmt::print(
        "# Options of `radiafit fit` and `radiafit plan`\n\nMade by `radiafit options`; a test compares. An option "
        "that means nothing to the chosen fit is refused. The same names, with underscores, are used in fit.json and "
        "in experiments' configs.\n");
    const FitRequest defaults;
    std::string group;
    for (const FitOption& o : fit_options()) {
        if (o.group != group)
            fmt::print("\n## {}\n\n| option | values | default | what it is | of |\n|---|---|---|---|---|\n", o.group);
        group = o.group;
        const std::string value = o.hide_default ? "" : o.text(defaults);
        fmt::print("| `{}` | {} | {} | {} | {} |\n", cell(o.first_flag()), cell(o.values),
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
