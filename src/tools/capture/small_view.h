#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "capture/photographs.h"
#include "dataset/dataset.h"
#include "geometry/camera.h"

namespace radiafit::tools {

/// A photograph so small that those of a capture fit into memory together, to check cameras, mesh and masks by.
struct SmallView {
    std::string name;
    Camera camera;
    std::vector<float> rgb;     ///< [height][width][3], sRGB-coded, 1 = white; not a number: shows nothing
    std::vector<uint8_t> mask;  ///< [height][width], not 0 = object; empty: unknown
};

inline constexpr int small_view_side =
    192;  ///< pixels: longer sides are made less than twice as long, if the shorter allows

/// Means of blocks of pixels.
SmallView small_view(const Photograph& photograph, const LoadedPhotograph& loaded);

/// Of the training and held-out images of a packed dataset, up to `most` of them, spread over the list. With gains.
std::vector<SmallView> small_views(const Dataset& dataset, size_t most);

}  // namespace radiafit::tools
