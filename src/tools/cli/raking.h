#pragma once
#include "cli/render_options.h"
#include "fitting/family.h"

namespace radiafit::tools {

/// Pictures under a distant lamp of intensity 1 that goes around, so many degrees above the surface: over a grid above
/// its plane, from above the first row clockwise; of a mesh above the picture of `shown`, from its top. Named by the
/// lamp's side: raking_000_top, raking_045_top_right, ... `shown`: the view that lends its camera. Says how far the
/// lamps lie beyond those that were fitted.
void render_raking(const RenderOptions& options, Fitted& fitted, const View& shown);

}  // namespace radiafit::tools
