#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "command_line/command_line.h"
#include "fitting/solvers/solve.h"

/// The subcommands of `radiafit`. Each add_ function declares one: its options, and what runs when it is chosen.
namespace radiafit::tools {

/// What main() was called with, for provenance.
struct Invocation {
    int argc;
    const char* const* argv;
};

void add_generate(CommandLine& program);
void add_capture(CommandLine& program);
void add_import(CommandLine& program, const Invocation& invocation);
void add_info(CommandLine& program);
void add_plan(CommandLine& program);
void add_fit(CommandLine& program, const Invocation& invocation);
void add_merge(CommandLine& program, const Invocation& invocation);
void add_export(CommandLine& program, const Invocation& invocation);
void add_export_files(CommandLine& exporter);  ///< its commands for what isn't solved further
void add_model(CommandLine& program);
void add_solve(CommandLine& program, const Invocation& invocation);
void add_judge(CommandLine& program);
void add_tune(CommandLine& program);
void add_render(CommandLine& program);
void add_publish(CommandLine& program);
void add_devices(CommandLine& program);
void add_options(CommandLine& program);
void add_completion(CommandLine& program);
/// `status`: what the program shall end with where runs differ.
void add_compare(CommandLine& program, int& status);

/// --json, of the commands that report results: one object on standard output, and no messages.
void add_json(CommandLine& command, bool& json);

/// What --json says of an output that was there already, made by the same command.
void print_done(const std::string& output, bool json);

/// Throws UserError unless an output's name ends so.
void require_ending(const std::filesystem::path& file, const std::string& ending);

/// --force, of the commands that compare what they need with what is free.
void add_force(CommandLine& command, bool& force);

/// --pixel-points, of the commands that show fits; none: as the fit says.
void add_pixel_points(CommandLine& command, std::optional<int>& points);
/// Throws UserError for a number that can't be.
void check_pixel_points(const std::optional<int>& points);

/// A packed dataset, or a fit, that a command writes.
OutputTarget fit_target(const std::filesystem::path& folder);
OutputTarget dataset_target(const std::filesystem::path& folder);
/// What a dataset is, on standard output.
void print_dataset(const Dataset& dataset, bool json);

/// The options of FitRequest, for every command that fits or plans a fit; or one of them, by its name in the table.
void add_fit_options(CommandLine& command, FitRequest& request);
void add_fit_option(CommandLine& command, FitRequest& request, const std::string& name);

}  // namespace radiafit::tools
