#pragma once
#include "cli/render_options.h"
#include "fitting/family.h"

namespace radiafit::tools {

/// The fit as `render` is asked to show it: as it is, or enhanced, and then told by which normals. `fitted` must
/// outlive it, and stay where it is.
Contestant shown_fit(const RenderOptions& options, Fitted& fitted);

/// Throws UserError for a fit that keeps its light. option: "--light".
void require_lamps(const Fitted& fitted, const char* option);

/// Warns where views lie so far from the images that were fitted that they show only this share of the fit.
void describe_share(double share);

}  // namespace radiafit::tools
