#pragma once
#include "cli/render_options.h"
#include "fitting/family.h"

namespace radiafit::tools {

/// Frames turn000.png, turn000.exr, ... in the output's folder, and a film where one was asked for. The camera goes
/// around a mesh, along where training photographs were (eval/turntable.h), and frames it. Over a grid the camera stays
/// and the lamp moves along where training lamps were; where each of these stood at its camera, as a flash does, the
/// camera goes with it. `shown`: the view that lends its size, and its lamp or camera.
void render_turntable(const RenderOptions& options, Fitted& fitted, const View& shown);

}  // namespace radiafit::tools
