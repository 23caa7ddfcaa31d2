#pragma once
#include <span>

#include "compute/compute_options.h"
#include "fragment/fragment_plan.h"

namespace radiafit {

/// What a ComputeEngine over cached samples holds at most, vectors like p not counted, and what building that takes.
/// images: fitted. samples: about how many. sample_bytes: of one in one order on the device, 4 or 8.
std::vector<PlannedArray> plan_cached_samples(const TriangleAtlas& atlas, const VertexRings& rings,
                                              const LfmLayout& layout, Accumulate accumulate, uint64_t images,
                                              uint64_t samples, uint64_t sample_bytes);
/// What a ComputeEngine that distributes the views' images in every sweep holds, vectors like p not counted.
std::vector<PlannedArray> plan_redistribution(const Dataset& dataset, const TriangleAtlas& atlas,
                                              const VertexRings& rings, const LfmLayout& layout, Accumulate accumulate,
                                              std::span<const uint32_t> views, const StreamOptions& stream);

}  // namespace radiafit
