#pragma once
#include "cli/render_options.h"
#include "fitting/family.h"

namespace radiafit::tools {

/// The fit as `render` is asked to show it: as it is, or enhanced, and then told by which normals. `fitted` must
/// outlive it, and stay where it is.
Contestant shown_fit(const RenderOptions& options, Fitted& fitted);

/// Throws UserError for a fit that keeps its light. option: "--light".
void require_lamps(const Fitted& fitted, const char* option);

/// Whether views with this share of the fit lie so far from the images that were fitted that they are a guess.
bool is_guess(const Fitted& fitted, double share);
/// What such views show.
std::string share_in_words(const Fitted& fitted, double share);
/// Warns of it.
void describe_share(const Fitted& fitted, double share);

}  // namespace radiafit::tools
