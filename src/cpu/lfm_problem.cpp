#include "cpu/lfm_problem.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "model/lfm_start.h"
#include "model/lfm_text.h"

namespace radiafit {
namespace {

constexpr int max_terms = 16;

template <class real>
inline Lanes<real> load_sample(const Sample& s) {
    using Shorts = uint16_t __attribute__((vector_size(8)));
    Shorts packed;
    __builtin_memcpy(&packed, &s, sizeof packed);
    return __builtin_convertvector(packed, Lanes<real>);  // the fourth lane holds the texel; a zero weight removes it
}

}  // namespace

template <class real>
LfmProblem<real>::LfmProblem(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const SampleList& samples, const LfmOptions& options)
    : rings_(&rings),
      samples_(&samples),
      options_(options),
      layout_(rings, int(atlas.texels_per_tile()), options.view_side, options.terms),
      tile_neighbours_(MapNeighbours::triangle(options.surface_side)),
      view_neighbours_(MapNeighbours::square(options.view_side)) {
    check_options(options);
    for (uint32_t local = 0; local < atlas.texels_per_tile(); ++local)
        for (int corner = 0; corner < 3; ++corner)
            target_weight_[corner].push_back(
                broadcast3<real>(real(atlas.barycentric(local)[corner]) * real(samples.scale)));
    const auto frames = vertex_frames(atlas.mesh());
    const size_t images = samples.image_count();
    std::vector<Vec3d> centers;
    for (uint32_t view : samples.views) centers.push_back(dataset.views[view].camera.center());
    footprints_.resize(vertex_count() * images);
    parallel_for(vertex_count(), 64, [&](size_t v, int) {
        for (size_t i = 0; i < images; ++i) {
            const ViewFootprint f =
                view_footprint(frames[v], atlas.mesh().positions[v], centers[i], options.view_side, options.lookup);
            footprints_[v * images + i] = {f.texel, {f.weight[0], f.weight[1], f.weight[2], f.weight[3]}};
        }
    });
}

template <class real>
ProblemStatistics LfmProblem<real>::count() {
    ProblemStatistics statistics;
    statistics.samples.assign(vertex_count(), 0);
    statistics.mean.assign(3 * vertex_count(), 0.0f);
    inverse_density_.assign(vertex_count(), real(1));
    lambda_view_.assign(vertex_count(), V{});
    parallel_for(vertex_count(), 64, [&](size_t v, int) {
        Lanes<double> sum{};
        uint32_t count = 0;
        for (const Corner& c : rings_->ring(v)) {
            const uint32_t first = samples_->groups[samples_->tile_groups[c.triangle]].first;
            const uint32_t last = samples_->groups[samples_->tile_groups[c.triangle + 1]].first;
            V part{};
            for (uint32_t s = first; s < last; ++s)
                part += target_weight_[c.corner][samples_->samples[s].local] * load_sample<real>(samples_->samples[s]);
            sum += widen<real>(part);
            count += last - first;
        }
        statistics.samples[v] = count;
        if (count == 0) return;
        inverse_density_[v] = real(double(ring_texels(v)) / count);
        for (int c = 0; c < 3; ++c) {
            const float mean = float(sum[c] / count);
            statistics.mean[3 * v + c] = mean;
            lambda_view_[v][c] = scaled_lambda_view(options_, ring_texels(v), mean);
        }
    });
    return statistics;
}

template <class real>
template <int K, bool Diagonal>
void LfmProblem<real>::accumulate_direction(size_t v, const V* p, V* g, V* diagonal, Lanes<double>& error) const {
    using Text = LfmText<real, V>;
    const int terms = K ? K : layout_.terms();
    const size_t tile = size_t(layout_.tile_texels()) * terms;
    const size_t row = size_t(layout_.view_side()) * terms;
    const size_t view_base = rings_->ring(v).size() * tile;
    size_t map = 0;
    for (const Corner& corner : rings_->ring(v)) {
        const V* surface = p + map;
        V* surface_gradient = g + map;
        const V* target_weight = target_weight_[corner.corner].data();
        for (uint32_t group = samples_->tile_groups[corner.triangle];
             group < samples_->tile_groups[corner.triangle + 1]; ++group) {
            const Footprint& f = footprint(v, samples_->groups[group].image);
            const size_t texel[4] = {view_base + size_t(f.texel) * terms, texel[0] + terms, texel[0] + row,
                                     texel[0] + row + terms};
            V h[max_terms], scatter[max_terms], squares[max_terms];
            for (int k = 0; k < terms; ++k) {
                h[k] = f.weight[0] * p[texel[0] + k] + f.weight[1] * p[texel[1] + k] + f.weight[2] * p[texel[2] + k] +
                       f.weight[3] * p[texel[3] + k];
                scatter[k] = squares[k] = V{};
            }
            V part{};
            for (const Sample& s : samples_->of_group(group)) {
                V r = -(target_weight[s.local] * load_sample<real>(s));
                const V* gs = surface + size_t(s.local) * terms;
                for (int k = 0; k < terms; ++k) r += Text::lfm_value(gs[k], h[k]);
                part += r * r;
                V* out = surface_gradient + size_t(s.local) * terms;
                for (int k = 0; k < terms; ++k) {
                    out[k] += Text::lfm_gradient_surface(r, h[k]);
                    scatter[k] += Text::lfm_gradient_view(r, gs[k]);
                    if constexpr (Diagonal) {
                        diagonal[map + size_t(s.local) * terms + k] += h[k] * h[k];
                        squares[k] += gs[k] * gs[k];
                    }
                }
            }
            error += 0.5 * widen<real>(part);
            for (int k = 0; k < terms; ++k)
                for (int j = 0; j < 4; ++j) {
                    g[texel[j] + k] += f.weight[j] * scatter[k];
                    if constexpr (Diagonal) diagonal[texel[j] + k] += f.weight[j] * f.weight[j] * squares[k];
                }
        }
        map += tile;
    }
}

template <class real>
template <int K>
void LfmProblem<real>::accumulate_line(size_t v, const V* p, const V* d, LineLanes& sums) const {
    using Text = LfmText<real, V>;
    const int terms = K ? K : layout_.terms();
    const size_t tile = size_t(layout_.tile_texels()) * terms;
    const size_t row = size_t(layout_.view_side()) * terms;
    const size_t view_base = rings_->ring(v).size() * tile;
    size_t map = 0;
    for (const Corner& corner : rings_->ring(v)) {
        const V* target_weight = target_weight_[corner.corner].data();
        for (uint32_t group = samples_->tile_groups[corner.triangle];
             group < samples_->tile_groups[corner.triangle + 1]; ++group) {
            const Footprint& f = footprint(v, samples_->groups[group].image);
            const size_t texel[4] = {view_base + size_t(f.texel) * terms, texel[0] + terms, texel[0] + row,
                                     texel[0] + row + terms};
            V h[max_terms], dh[max_terms];
            for (int k = 0; k < terms; ++k) {
                h[k] = dh[k] = V{};
                for (int j = 0; j < 4; ++j) {
                    h[k] += f.weight[j] * p[texel[j] + k];
                    dh[k] += f.weight[j] * d[texel[j] + k];
                }
            }
            V aa{}, rb{}, ab{}, bb{};
            for (const Sample& s : samples_->of_group(group)) {
                V r = -(target_weight[s.local] * load_sample<real>(s));
                V a{}, b{};
                const size_t at = map + size_t(s.local) * terms;
                for (int k = 0; k < terms; ++k) {
                    r += Text::lfm_value(p[at + k], h[k]);
                    a += Text::lfm_slope(p[at + k], h[k], d[at + k], dh[k]);
                    b += Text::lfm_bend(d[at + k], dh[k]);
                }
                aa += a * a;
                rb += r * b;
                ab += a * b;
                bb += b * b;
            }
            sums.gauss_newton += widen<real>(aa);
            sums.curvature += widen<real>(aa) + 2.0 * widen<real>(rb);
            sums.third += widen<real>(ab);
            sums.fourth += widen<real>(bb);
        }
        map += tile;
    }
}

template <class real>
void LfmProblem<real>::precondition(size_t v, V* diagonal) const {
    const size_t view_base = rings_->ring(v).size() * size_t(layout_.tile_texels()) * layout_.terms();
    const size_t size = layout_.block_size(v) / 4;
    const real lambda = options_.lambda_surface;
    V largest{};
    for (size_t i = 0; i < size; ++i) {
        diagonal[i] =
            diagonal[i] * inverse_density_[v] + real(20) * (i < view_base ? broadcast3(lambda) : lambda_view_[v]);
        largest = diagonal[i] > largest ? diagonal[i] : largest;
    }
    const V floor = real(1e-4) * largest + V{real(1e-30), real(1e-30), real(1e-30), real(1)};
    for (size_t i = 0; i < size; ++i) diagonal[i] = diagonal[i] > floor ? diagonal[i] : floor;
}

template <class real>
void LfmProblem<real>::direction(size_t v, const V* x, V* gradient, V* diagonal, double error[3]) const {
    const size_t size = layout_.block_size(v) / 4;
    std::fill(gradient, gradient + size, V{});
    if (diagonal) std::fill(diagonal, diagonal + size, V{});
    Lanes<double> data{};
    const auto run = [&]<int K>() {
        if (diagonal)
            accumulate_direction<K, true>(v, x, gradient, diagonal, data);
        else
            accumulate_direction<K, false>(v, x, gradient, diagonal, data);
    };
    switch (layout_.terms()) {
        case 1:
            run.template operator()<1>();
            break;
        case 2:
            run.template operator()<2>();
            break;
        case 3:
            run.template operator()<3>();
            break;
        default:
            run.template operator()<0>();
    }
    const real scale = inverse_density_[v];
    for (size_t i = 0; i < size; ++i) gradient[i] *= scale;
    data *= double(scale);

    const int terms = layout_.terms();
    const size_t tile = size_t(layout_.tile_texels()) * terms;
    thread_local std::vector<V> scratch;
    scratch.resize(2 * std::max(layout_.tile_texels(), layout_.view_texels()));
    size_t at = 0;
    for (size_t r = 0; r < rings_->ring(v).size(); ++r, at += tile)
        add_smoothness<real>(tile_neighbours_, terms, broadcast3(real(options_.lambda_surface)), x + at, gradient + at,
                             data, scratch.data());
    add_smoothness<real>(view_neighbours_, terms, lambda_view_[v], x + at, gradient + at, data, scratch.data());
    add_bounds<real>(options_, size / terms, x, gradient, data);
    if (diagonal) precondition(v, diagonal);
    for (int c = 0; c < 3; ++c) error[c] = data[c];
}

template <class real>
void LfmProblem<real>::line(size_t v, const V* x, const V* d, LineLanes& sums) const {
    sums = {};
    switch (layout_.terms()) {
        case 1:
            accumulate_line<1>(v, x, d, sums);
            break;
        case 2:
            accumulate_line<2>(v, x, d, sums);
            break;
        case 3:
            accumulate_line<3>(v, x, d, sums);
            break;
        default:
            accumulate_line<0>(v, x, d, sums);
    }
    const double scale = inverse_density_[v];
    sums.gauss_newton *= scale;
    sums.curvature *= scale;
    sums.third *= scale;
    sums.fourth *= scale;

    const int terms = layout_.terms();
    const size_t tile = size_t(layout_.tile_texels()) * terms;
    thread_local std::vector<V> scratch;
    scratch.resize(std::max(layout_.tile_texels(), layout_.view_texels()));
    V penalty{};
    size_t at = 0;
    for (size_t r = 0; r < rings_->ring(v).size(); ++r, at += tile)
        penalty += smoothness_curvature<real>(tile_neighbours_, terms, broadcast3(real(options_.lambda_surface)),
                                              d + at, scratch.data());
    penalty += smoothness_curvature<real>(view_neighbours_, terms, lambda_view_[v], d + at, scratch.data());
    penalty += bounds_curvature<real>(options_, layout_.block_size(v) / 4 / terms, x, d);
    sums.gauss_newton += widen<real>(penalty);
    sums.curvature += widen<real>(penalty);
}

template class LfmProblem<float>;
template class LfmProblem<double>;

}  // namespace radiafit
