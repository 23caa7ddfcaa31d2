#pragma once
#include <optional>

#include "lamps/lit_relief.h"

namespace radiafit::tools {

/// How a light file's x and y lie against the images: file = turned(degrees) * (mirrored ? y down : I) * world.
struct AxesTurn {
    bool mirrored = false;
    double degrees = 0;  ///< counterclockwise, 0 to 360
    Eigen::Matrix2d matrix() const;
};

/// What images say of the axes of their light file. The lamps' directions turned or mirrored leave a matt surface's
/// images as they are, so three other cues are asked. Gradients of a surface have no curl (integrability), which tells
/// all but half a turn; a near lamp is brighter on its side (falloff); a cast shadow lies away from the lamp behind
/// what turns away from it.
struct AxesFinding {
    AxesTurn turn;         ///< the likeliest
    double against = 0;    ///< chi squared by which the file as it is is less likely
    double runner_up = 0;  ///< chi squared by which the next likely turn of another kind is
};
AxesFinding judge_axes(const LightStack& stack, const LitRelief& relief);

}  // namespace radiafit::tools
