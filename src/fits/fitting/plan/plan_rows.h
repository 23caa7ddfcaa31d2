#pragma once
#include "compute/compute_plan.h"
#include "fitting/solvers/solve.h"
#include "geometry/atlas.h"

/// Rows that plans of several families have.
namespace radiafit::fits {

std::vector<PlanRow> rows_of(const std::vector<PlannedArray>& arrays);

/// What fitted views leave.
struct SampleEstimate {
    uint64_t samples = 0;  ///< pixels in texels
    uint64_t groups = 0;   ///< pairs of a tile and an image of which it takes samples
};
/// From every eighth of the fitted views but eight at least, or from `most_views`. `tiles`, if given, takes the samples
/// apart: counts of `tiles->size()` equal parts of the atlas's texels.
SampleEstimate estimate_samples(const Dataset& dataset, const Atlas& atlas, const FitRequest& request,
                                size_t most_views, std::vector<uint64_t>* tiles = nullptr);
/// The same where every texel that an image shows takes a sample of it. tiles: [tiles].
SampleEstimate estimate_interpolated(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                                     size_t most_views, std::vector<uint64_t>* tiles = nullptr);

/// The list of samples, and the same while it is brought into its tiles' order.
void add_samples(const SampleEstimate& seen, uint64_t tiles, unsigned stages, std::vector<PlanRow>& rows);
void add_mesh(const Dataset& dataset, std::vector<PlanRow>& rows);
/// What finds the pixels of texels: of each thread an image, what its pixels see, and its texels' pixels.
void add_distributors(const Dataset& dataset, const TriangleAtlas& atlas, const std::vector<uint32_t>& views,
                      std::vector<PlanRow>& rows);
/// What images that stream take of the host.
void add_host_images(const Dataset& dataset, const FitRequest& request, std::vector<PlanRow>& rows);
/// What a texel-local model's prior takes of so many texels (cpu/surface_prior.h).
PlanRow prior_row(const TexelModel& model, uint64_t texels);
/// What two-step holds of samples, `bytes` in all, while it sorts them.
PlanRow held_samples(const FitRequest& request, uint64_t bytes);

}  // namespace radiafit::fits
