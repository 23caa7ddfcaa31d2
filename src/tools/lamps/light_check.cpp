#include "lamps/light_check.h"

#include <cmath>

namespace radiafit::tools {
namespace {

constexpr double sure = 20, sure_which = 9;  // of chi squared
constexpr double quarter_turns = 12;         // degrees: so near to one of them, it is that

}  // namespace

LightFinding check_lights(const LightStack& stack) {
    LightFinding out;
    if ((out.order = find_order(stack))) return out;
    const AxesFinding axes = judge_axes(stack, fit_relief(stack));
    if (!(axes.against > sure)) return out;
    out.turn = axes.turn;
    out.turn_is_sure = axes.runner_up > sure_which;
    const double off = std::remainder(axes.turn.degrees, 90.0);
    if (std::abs(off) <= quarter_turns) out.turn->degrees = std::fmod(axes.turn.degrees - off, 360.0);
    return out;
}

}  // namespace radiafit::tools
