#pragma once
#include <optional>

#include "lamps/lamp_axes.h"
#include "lamps/lamp_order.h"

namespace radiafit::tools {

/// What is wrong with a light file by what its images show. Nothing: it suits them, or they cannot tell.
struct LightFinding {
    std::optional<OrderFinding> order;  ///< its entries are to go to other images
    std::optional<AxesTurn> turn;       ///< its axes lie so against the images' (in an order that suits)
    bool turn_is_sure = true;           ///< false: its axes don't suit, but turns of another kind may be it, too
};
LightFinding check_lights(const LightStack& stack);

}  // namespace radiafit::tools
