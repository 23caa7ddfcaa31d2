#include "cpu/lfm_objective.h"

#include <algorithm>

#include "model/lfm_start.h"

namespace radiafit {

template <class real>
LfmObjective<real>::LfmObjective(const LfmOptions& options)
    : options_(options),
      view_size_(size_t(options.view_side) * size_t(options.view_side) * size_t(options.terms)),
      view_neighbours_(MapNeighbours::square(options.view_side)) {}

template <class real>
typename LfmObjective<real>::Scale LfmObjective<real>::scale(size_t ring_texels, uint32_t samples,
                                                             const float* mean) const {
    Scale out;
    if (samples == 0) return out;
    out.inverse_density = real(inverse_density(options_, ring_texels, samples));
    for (int c = 0; c < 3; ++c) out.lambda_view[c] = scaled_lambda_view(options_, ring_texels, mean[c]);
    return out;
}

namespace {

template <class real>
Lanes<real>* scratch(size_t size) {
    thread_local std::vector<Lanes<real>> lanes;
    if (lanes.size() < size) lanes.resize(size);
    return lanes.data();
}

}  // namespace

/// Number of lanes of all surface maps, all terms.
template <class real>
size_t LfmObjective<real>::surface_size(std::span<const uint8_t> sides) const {
    size_t texels = 0;
    for (const int side : sides) texels += TriangleTile::texels_of(side);
    return texels * size_t(options_.terms);
}

template <class real>
void LfmObjective<real>::finish_direction(const Scale& scale, std::span<const uint8_t> sides, const V* x, V* gradient,
                                          V* diagonal, Lanes<double>& error) const {
    const size_t view_base = surface_size(sides), size = view_base + view_size_;
    for (size_t i = 0; i < size; ++i) gradient[i] *= scale.inverse_density;
    error *= double(scale.inverse_density);
    V* smooth = scratch<real>(2 * size);
    const V lambda = broadcast3(real(options_.lambda_surface));
    size_t at = 0;
    for (const int side : sides) {
        const MapNeighbours& tile = MapNeighbours::triangle(side);
        add_smoothness<real>(tile, options_.terms, lambda, x + at, gradient + at, error, smooth);
        at += tile.texel_count() * size_t(options_.terms);
    }
    add_smoothness<real>(view_neighbours_, options_.terms, scale.lambda_view, x + at, gradient + at, error, smooth);
    add_bounds<real>(options_, size / size_t(options_.terms), x, gradient, error);
    if (diagonal) precondition(scale, view_base, diagonal);
    if (first_term_ <= 0 && last_term_ >= options_.terms) return;
    for (size_t i = 0; i < size; ++i) {
        const int term = int(i % size_t(options_.terms));
        if (term < first_term_ || term >= last_term_) gradient[i] = V{};
    }
}

template <class real>
void LfmObjective<real>::precondition(const Scale& scale, size_t view_base, V* diagonal) const {
    const size_t size = view_base + view_size_;
    const V lambda = broadcast3(real(options_.lambda_surface));
    V largest{};
    for (size_t i = 0; i < size; ++i) {
        diagonal[i] = diagonal[i] * scale.inverse_density + real(20) * (i < view_base ? lambda : scale.lambda_view);
        largest = max(largest, diagonal[i]);
    }
    const V least = {real(1e-30), real(1e-30), real(1e-30), real(1)};
    for (size_t i = 0; i < size; ++i) diagonal[i] = ObjectiveText<real, V>::preconditioner(diagonal[i], largest, least);
}

template <class real>
void LfmObjective<real>::finish_line(const Scale& scale, std::span<const uint8_t> sides, const V* x, const V* d,
                                     LineLanes& sums) const {
    for (Lanes<double>* sum : {&sums.gauss_newton, &sums.curvature, &sums.third, &sums.fourth})
        *sum *= double(scale.inverse_density);
    if (!options_.corrections.penalty_curvature) return;
    V* smooth = scratch<real>(surface_size(sides) + view_size_);
    const V lambda = broadcast3(real(options_.lambda_surface));
    V penalty{};
    size_t at = 0;
    for (const int side : sides) {
        const MapNeighbours& tile = MapNeighbours::triangle(side);
        penalty += smoothness_curvature<real>(tile, options_.terms, lambda, d + at, smooth);
        at += tile.texel_count() * size_t(options_.terms);
    }
    penalty += smoothness_curvature<real>(view_neighbours_, options_.terms, scale.lambda_view, d + at, smooth);
    penalty += bounds_curvature<real>(options_, (at + view_size_) / size_t(options_.terms), x, d);
    sums.gauss_newton += widen<real>(penalty);
    sums.curvature += widen<real>(penalty);
}

template class LfmObjective<float>;
template class LfmObjective<double>;

}  // namespace radiafit
