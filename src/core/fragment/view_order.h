#pragma once
#include <cstdint>
#include <vector>

#include "dataset/dataset.h"

namespace radiafit {

/// The views in batches of neighbours in direction, seen from the mesh: a batch begins with the view farthest out among
/// those left and takes the ones nearest to it. A pass over a batch draws every triangle that some view of it faces, so
/// like views waste least. Deterministic.
std::vector<uint32_t> batches_of_neighbours(const Dataset& dataset, const std::vector<uint32_t>& views, int batch);

}  // namespace radiafit
