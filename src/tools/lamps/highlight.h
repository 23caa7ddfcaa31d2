#pragma once
#include <optional>

#include "lamps/sphere_outline.h"

namespace radiafit::tools {

/// A lamp's mirror image on a glossy sphere.
struct Highlight {
    Vec2d place = Vec2d::Zero();  ///< pixels: the light's centroid, less what surrounds it
    double deviation = 0;         ///< standard deviation of either coordinate by the image's noise, pixels
};

/// The brightest spot within the outline, and of several the most compact one. None: nothing stands out (less than
/// three times as bright as the brighter tenth around it), or what does is no spot (more than a fifth of the disc).
std::optional<Highlight> find_highlight(const LuminanceImage& image, const Circle& outline);

}  // namespace radiafit::tools
