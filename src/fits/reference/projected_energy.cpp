#include "reference/projected_energy.h"

#include <algorithm>

#include "model/with_terms.h"

namespace radiafit::fits {
namespace {

using V = Lanes<double>;

}  // namespace

ProjectedEnergy::ProjectedEnergy(const LfmVertex& vertex, const TileSmoothness& tiles, const Smoothness& view)
    : vertex_(vertex),
      view_(view),
      solve_surface_(vertex, tiles),
      first_group_(vertex.first_groups()),
      gradient_(vertex.view->texel_count() * vertex.terms()),
      own_(gradient_.size(), view_band(vertex.options, view)) {
    const size_t terms = vertex.terms();
    std::vector<bool> reached(vertex.view->texel_count(), false);
    for (size_t i = 0; i + 1 < vertex.groups.size(); ++i)
        for (int j = 0; j < 4; ++j) reached[vertex.corner(vertex.groups[i], j)] = true;
    touched_ = terms * size_t(std::ranges::count(reached, true));
    for (size_t t = 0, next = 0; t < reached.size(); ++t)
        for (size_t k = 0; k < terms; ++k) column_.push_back(reached[t] ? next++ : touched_);
    eliminated_.emplace(vertex.largest_tile() * terms, touched_);
}

/// Sums over the samples of one map; K = 0 where the number of terms isn't known beforehand. Returns the sum of
/// squares.
template <int K>
V ProjectedEnergy::add_samples(size_t map, const V* p) {
    const size_t terms = K ? K : vertex_.terms();
    const double weight = vertex_.inverse_density;
    const V* surface = p + vertex_.map_begin(map);
    const V* view = p + vertex_.view_begin();
    V squares{};
    for (size_t i = first_group_[map]; i < first_group_[map + 1]; ++i) {
        const LfmVertex::Group& group = vertex_.groups[i];
        constexpr size_t most = K ? K : max_terms;
        V h[most], slope[most] = {}, products[most * (most + 1) / 2] = {};
        size_t corner[4], column[4];
        float w[4];
        for (int j = 0; j < 4; ++j) {
            corner[j] = vertex_.corner(group, j) * terms;
            column[j] = column_[corner[j]];
            w[j] = float(group.weight[j] * weight);
        }
        for (size_t k = 0; k < terms; ++k) {
            h[k] = V{};
            for (int j = 0; j < 4; ++j) h[k] += group.weight[j] * view[corner[j] + k];
        }
        const uint32_t end = vertex_.groups[i + 1].first;
        for (uint32_t s = group.first; s < end; ++s) {
            const size_t at = vertex_.local[s] * terms;
            const V* g = surface + at;
            V r = -vertex_.target[s];
            for (size_t k = 0; k < terms; ++k) r += g[k] * h[k];
            squares += r * r;
            for (size_t k = 0, n = 0; k < terms; ++k) {
                slope[k] += r * g[k];
                for (size_t l = 0; l <= k; ++l, ++n) products[n] += g[k] * g[l];
                for (size_t l = 0; l < terms; ++l) {
                    const V mixed = l == k ? g[l] * h[k] + r : g[l] * h[k];
                    const auto narrow = __builtin_convertvector(mixed, Lanes<float>);
                    for (int j = 0; j < 4; ++j) eliminated_->x(at + k, column[j] + l) += w[j] * narrow;
                }
            }
        }
        add_view_sums<K>(vertex_, group, products, slope, own_, gradient_.data());
    }
    return squares;
}

bool ProjectedEnergy::evaluate(V* p) {
    if (!solve_surface_(p)) return false;
    std::fill(gradient_.begin(), gradient_.end(), V{});
    own_.clear();
    eliminated_->clear_sum();
    V squares{};
    for (size_t map = 0; map < vertex_.maps(); ++map) {
        eliminated_->clear_x();
        squares += with_terms(vertex_.options.terms, [&](auto k) { return add_samples<k>(map, p); });
        eliminated_->add(solve_surface_.factor(map));
    }
    const size_t terms = vertex_.terms();
    const V* view = p + vertex_.view_begin();
    for (const auto& e : view_.entries)
        for (size_t k = 0; k < terms; ++k) {
            const size_t i = e.row * terms + k, j = e.column * terms + k;
            const V value = vertex_.lambda_view * e.value;
            own_.at(i, j) += value;
            gradient_[i] += value * view[j];
            if (i != j) gradient_[j] += value * view[i];
        }
    error_ = 0.5 * vertex_.inverse_density * squares + lfm_penalties(vertex_, p);
    return true;
}

}  // namespace radiafit::fits
