#include "reachable/reachable.h"

#include "reachable/gaussian_process.h"
#include "reachable/lumigraph.h"

namespace radiafit::fits {
namespace {

constexpr ReachableModel models[] = {
    {"lumigraph", "unstructured lumigraph",
     [](const Dataset& dataset, const std::vector<uint32_t>& views, TargetSpace space) {
         return lumigraph_of(dataset, views, space);
     }},
    {"gaussian-process", "Gaussian process per texel",
     [](const Dataset& dataset, const std::vector<uint32_t>& views, TargetSpace space) {
         return gaussian_process_of(dataset, views, space);
     }},
};

}  // namespace

std::span<const ReachableModel> reachable_models() { return models; }

}  // namespace radiafit::fits
