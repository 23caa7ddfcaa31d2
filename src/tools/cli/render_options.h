#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "command_line/command_line.h"
#include "eval/render.h"
#include "eval/specular_enhancement.h"

namespace radiafit::tools {

/// What `radiafit render` is asked for.
struct RenderOptions {
    std::string fit, output, dataset;
    std::optional<int> view;
    int turntable = 0;
    bool full_circle = false;
    std::string video;              ///< a film of the turntable; or empty
    std::string all;                ///< of which split every view is shown; empty: one
    std::vector<double> light;      ///< direction, or empty
    std::optional<double> raking;   ///< degrees of the lamp above the surface
    std::optional<int> directions;  ///< of raking light; none: 8
    std::optional<SpecularEnhancement> enhancement;
    std::optional<std::array<int, 2>> size;  ///< width and height
    Background background;
    std::optional<int> pixel_points;
    bool problems = false;

    /// Into a folder, or a film.
    bool makes_many() const { return turntable > 0 || raking || !all.empty(); }
    int points() const { return pixel_points.value_or(as_photographed); }
    /// The view with the whole photograph as its picture, in the size that was asked for.
    View framed(View shown, const Dataset& dataset) const;
};

/// Adds all of them to the command.
void add_render_options(CommandLine& command, RenderOptions& options);
/// The view that was asked for, or one from the middle of those held out. Throws UserError for one that isn't there.
uint32_t chosen_view(const Dataset& dataset, std::optional<int> view);
/// Throws UserError for an output that cannot be, or is missing.
void check_render_output(const RenderOptions& options);

}  // namespace radiafit::tools
