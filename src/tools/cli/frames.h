#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cli/render_options.h"

namespace radiafit::tools {

/// A picture of many: its name in the output's folder, and what it shows.
struct NamedView {
    std::string name;
    View view;
};

/// Makes so many pictures, make(i, worker), as many at once as there are threads. The first one, by itself, tells how
/// long the others will take, which is said before they begin.
void make_pictures(const char* task, size_t count, const std::function<void(size_t i, int worker)>& make);

/// Renders them into the output's folder, if there is one, and as a film where one was asked for. what: for the
/// progress. Returns the least share of the fit that one of them shows.
double render_frames(const RenderOptions& options, const Contestant& fit, const Dataset& dataset,
                     const std::vector<NamedView>& frames, const char* what);

}  // namespace radiafit::tools
