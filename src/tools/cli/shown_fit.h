#pragma once
#include "cli/render_options.h"
#include "fitting/family.h"

namespace radiafit::tools {

/// The fit as `render` is asked to show it: as it is, or enhanced, and then told by which normals. `fitted` must
/// outlive it, and stay where it is.
Contestant shown_fit(const RenderOptions& options, Fitted& fitted);

/// Throws UserError for a fit that keeps its light. option: "--light".
void require_lamps(const Fitted& fitted, const char* option);

/// What views show that lie so far from the images that were fitted that this share of the fit, below 1, is left.
std::string share_in_words(const Fitted& fitted, double share);
/// Warns of it, where it is below 1.
void describe_share(const Fitted& fitted, double share);

}  // namespace radiafit::tools
