#include "cpu/lfm_problem.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cpu/ring_samples.h"

namespace radiafit {
namespace {

/// A group of the list as the kernels read it.
template <class real>
struct GroupSamples {
    std::span<const Sample> samples;
    const Lanes<real>* weight;  ///< [tile texels]
    size_t size() const { return samples.size(); }
    uint32_t texel(size_t i) const { return samples[i].local; }
    Lanes<real> target(size_t i) const { return weight[texel(i)] * load_sample<real>(&samples[i]); }
    PairLanes<real> targets(size_t i) const {
        return join<real>(weight[texel(i)], weight[texel(i + 1)]) * load_two_samples<real>(&samples[i]);
    }
};

}  // namespace

template <class real>
LfmProblem<real>::LfmProblem(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const SampleList& samples, const LfmOptions& options)
    : rings_(&rings),
      samples_(&samples),
      options_((check_options(options), options)),
      layout_(rings, atlas, options.view_side, options.terms),
      objective_(options),
      target_weights_(atlas, samples.scale) {
    const auto frames = vertex_frames(atlas.mesh());
    const size_t images = samples.image_count();
    std::vector<Vec3d> centers;
    for (uint32_t view : samples.views) centers.push_back(dataset.views[view].camera.center());
    footprints_.resize(vertex_count() * images);
    if (options.loss.weighted()) weights_.resize(footprints_.size());
    parallel_for(vertex_count(), 64, [&](size_t v, int) {
        for (size_t i = 0; i < images; ++i) {
            const ViewFootprint f =
                view_footprint(frames[v], atlas.mesh().positions[v], centers[i], options.view_side, options.lookup);
            footprints_[v * images + i] = {f.texel, {f.weight[0], f.weight[1], f.weight[2], f.weight[3]}};
            if (!weights_.empty())
                weights_[v * images + i] =
                    real(view_weight(frames[v], atlas.mesh().positions[v], centers[i], options.loss.weights));
        }
    });
}

template <class real>
ProblemStatistics LfmProblem<real>::count() {
    const ProblemStatistics statistics = count_rings(*rings_, *samples_, target_weights_);
    scales_.resize(vertex_count());
    for (size_t v = 0; v < vertex_count(); ++v)
        scales_[v] = objective_.scale(texels(v), statistics.samples[v], &statistics.mean[3 * v]);
    counts_ = statistics.samples;
    return statistics;
}

template <class real>
void LfmProblem<real>::direction(size_t v, const V* x, V* gradient, V* diagonal, double error[3]) const {
    const size_t size = layout_.block_size(v) / 4, view = layout_.surface_texels(v) * size_t(options_.terms);
    const auto ring = rings_->ring(v);
    const auto sides = layout_.sides(v);
    std::fill(gradient, gradient + size, V{});
    if (diagonal) std::fill(diagonal, diagonal + size, V{});
    Lanes<double> data{};
    const auto sum = [&](auto kernel) {
        size_t map = 0;  // where it begins
        for (size_t position = 0; position < ring.size(); ++position) {
            const Corner& corner = ring[position];
            for (uint32_t group = samples_->tile_groups[corner.triangle];
                 group < samples_->tile_groups[corner.triangle + 1]; ++group) {
                const uint32_t image = samples_->groups[group].image;
                const Footprint<real>& f = footprint(v, image);
                const GroupSamples<real> samples{samples_->of_group(group),
                                                 target_weights_.of(corner, sides[position])};
                kernel.begin(f, x + view, weight(v, image));
                kernel.add(samples, x + map, gradient + map, diagonal ? diagonal + map : nullptr);
                kernel.end(f, gradient + view, diagonal ? diagonal + view : nullptr, data);
            }
            map += TriangleTile::texels_of(sides[position]) * size_t(options_.terms);
        }
    };
    with_kernels(options_, [&](auto terms, auto loss) {
        if (diagonal)
            sum(DirectionKernel<real, terms, true, decltype(loss)>(options_.terms, options_.view_side, loss));
        else
            sum(DirectionKernel<real, terms, false, decltype(loss)>(options_.terms, options_.view_side, loss));
    });
    objective_.finish_direction(scales_[v], sides, x, gradient, diagonal, data);
    for (int c = 0; c < 3; ++c) error[c] = data[c];
}

template <class real>
void LfmProblem<real>::line(size_t v, const V* x, const V* d, LineLanes& sums) const {
    sums = {};
    const size_t view = layout_.surface_texels(v) * size_t(options_.terms);
    const auto ring = rings_->ring(v);
    const auto sides = layout_.sides(v);
    with_kernels(options_, [&](auto terms, auto loss) {
        LineKernel<real, terms, decltype(loss)> kernel(options_.terms, options_.view_side, loss);
        size_t map = 0;  // where it begins
        for (size_t position = 0; position < ring.size(); ++position) {
            const Corner& corner = ring[position];
            for (uint32_t group = samples_->tile_groups[corner.triangle];
                 group < samples_->tile_groups[corner.triangle + 1]; ++group) {
                const uint32_t image = samples_->groups[group].image;
                const Footprint<real>& f = footprint(v, image);
                const GroupSamples<real> samples{samples_->of_group(group),
                                                 target_weights_.of(corner, sides[position])};
                kernel.begin(f, x + view, d + view, weight(v, image));
                kernel.add(samples, x + map, d + map);
                kernel.end(sums);
            }
            map += TriangleTile::texels_of(sides[position]) * size_t(options_.terms);
        }
    });
    objective_.finish_line(scales_[v], sides, x, d, sums);
}

template class LfmProblem<float>;
template class LfmProblem<double>;

}  // namespace radiafit
