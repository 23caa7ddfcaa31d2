#pragma once
#include <span>
#include <string>
#include <vector>

#include "fragment/fragment_options.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "model/lfm.h"
#include "optim/verbs.h"

namespace radiafit {

/// One kind of array that the fragment engine holds on the device.
struct PlannedArray {
    std::string array, shape;
    uint64_t count, bytes;  ///< count: texels, or bytes of buffers
};

/// The row of what is on its way to a chip; software has none of it.
inline constexpr const char* on_their_way = "images on their way to the device";

/// What images stream through: textures for two batches of them, and the two buffers that the device fetches them from;
/// or, if kept on the device, a texture for each image.
void plan_images(std::vector<PlannedArray>& plan, const Dataset& dataset, std::span<const uint32_t> views,
                 uint64_t batch, int bits, bool keep_on_device);

/// What FragmentEngine would allocate, without a context: the sum is what its bytes() would say on a chip (in software
/// less by the row on_their_way), but for combined
/// passes on a device with fewer than 124 varying components.
std::vector<PlannedArray> plan_fragment_engine(const Dataset& dataset, const TriangleAtlas& atlas,
                                               const VertexRings& rings, std::span<const uint32_t> views,
                                               const LfmOptions& options, const FragmentOptions& fragment_options,
                                               const Room& room = {});

}  // namespace radiafit
