#pragma once
#include <string>
#include <vector>

#include "cli/render_options.h"

namespace radiafit::tools {

/// A picture of many: its name in the output's folder, and what it shows.
struct NamedView {
    std::string name;
    View view;
};

/// Renders them into the output's folder, if there is one, and as a film where one was asked for. what: for the
/// progress. Returns the least share of the fit that one of them shows.
double render_frames(const RenderOptions& options, const Contestant& fit, const Dataset& dataset,
                     const std::vector<NamedView>& frames, const char* what);

}  // namespace radiafit::tools
