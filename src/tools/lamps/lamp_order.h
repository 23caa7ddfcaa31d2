#pragma once
#include <optional>
#include <string>
#include <vector>

#include "lamps/light_stack.h"

namespace radiafit::tools {

/// A way in which a light file's entries may have been put to other images.
struct OrderFinding {
    enum class Kind { reversed, shifted, by_number, swapped, unknown };
    Kind kind = Kind::unknown;
    std::vector<uint32_t> entry = {};  ///< [images] whose entry is each image's lamp; empty if unknown
    int shift = 0;                     ///< shifted: the lamp of image i is entry i + shift, round about
    double explained = 0;              ///< share of what lamps can explain that the file explains
    double explained_so = 0;           ///< that it explains in this order
};

/// Whether the images are lit as the file says, in its order: a matt surface's images are sums of three, weighted by
/// the lamp's direction (Shashua 1997). None: they are, or nothing can be told.
std::optional<OrderFinding> find_order(const LightStack& stack);

}  // namespace radiafit::tools
