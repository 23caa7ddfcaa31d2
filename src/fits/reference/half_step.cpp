#include "reference/half_step.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "model/with_terms.h"

namespace radiafit::fits {
namespace {

using V = Lanes<double>;

}  // namespace

Smoothness::Smoothness(const MapNeighbours& map) {
    const size_t n = map.texel_count();
    std::vector<std::map<uint32_t, double>> rows(n);  // of the lower triangle
    for (uint32_t r = 0; r < n; ++r) {  // one row of L: the number kept at the centre, -1 at each neighbour
        std::vector<std::pair<uint32_t, double>> row = {{r, double(map.of(r).size())}};
        for (uint16_t j : map.of(r)) row.emplace_back(j, -1.0);
        for (const auto& [i, a] : row)
            for (const auto& [j, b] : row)
                if (j <= i) rows[i][j] += a * b;
    }
    for (uint32_t i = 0; i < n; ++i)
        for (const auto& [j, value] : rows[i])
            if (value != 0) {
                entries.push_back({i, j, value});
                band = std::max(band, size_t(i - j));
            }
}

TileSmoothness::TileSmoothness(const LfmOptions& model) : of_side_(size_t(model.surface_side) + 1) {
    const auto add = [&](int side) {
        if (!of_side_[size_t(side)]) of_side_[size_t(side)].emplace(MapNeighbours::triangle(side));
    };
    if (!model.sides) add(model.surface_side);
    for (size_t t = 0; model.sides && t < model.sides->size(); ++t) add((*model.sides)[t]);
}

size_t surface_band(const LfmOptions& model, const Smoothness& tile) {
    return (tile.band + 1) * size_t(model.terms) - 1;
}

size_t view_band(const LfmOptions& model, const Smoothness& view) {
    const size_t texels = std::max(view.band, size_t(model.view_side) + 1);
    return (texels + 1) * size_t(model.terms) - 1;
}

HalfStep::HalfStep(size_t texels, size_t band, size_t terms)
    : terms_(terms),
      a_(texels * terms, band),
      factor_(a_),
      b_(texels * terms),
      solution_(texels * terms),
      active_(texels),
      next_(texels) {}

void HalfStep::clear() {
    a_.clear();
    std::fill(b_.begin(), b_.end(), V{});
}

void HalfStep::add_smoothness(const Smoothness& s, V lambda) {
    for (const auto& e : s.entries)
        for (size_t k = 0; k < terms_; ++k) a_.at(e.row * terms_ + k, e.column * terms_ + k) += lambda * e.value;
}

unsigned HalfStep::solve(const LfmOptions& o, V* x) {
    V largest{};
    for (size_t i = 0; i < a_.size(); ++i) largest = a_.at(i, i) > largest ? a_.at(i, i) : largest;
    // Far below what moves E_t in double, and enough to hold a parameter that nothing else does.
    const V ridge = largest > 0 ? 1e-12 * largest : V{1, 1, 1, 1};
    for (size_t i = 0; i < a_.size(); ++i) {
        a_.at(i, i) += ridge;
        b_[i] += ridge * x[i];
    }
    beyond_bounds(o, x, active_);
    for (int guess = 0; guess < 8; ++guess) {
        factor_ = a_;
        solution_ = b_;
        for (size_t t = 0; t < active_.size(); ++t)
            for (int c = 0; c < 3; ++c)
                if (active_[t][c] != 0) {
                    factor_.at(t * terms_, t * terms_)[c] += double(o.mu);
                    solution_[t * terms_][c] += double(o.mu) * double(active_[t][c] < 0 ? o.lower : o.upper);
                }
        if (const unsigned bad = factor_.factor()) return bad;
        factor_.solve(solution_.data());
        beyond_bounds(o, solution_.data(), next_);
        const bool same = std::equal(active_.begin(), active_.end(), next_.begin(), [](const V& p, const V& q) {
            return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
        });
        if (same) break;
        std::swap(active_, next_);
    }
    std::copy(solution_.begin(), solution_.end(), x);
    return 0;
}

void HalfStep::beyond_bounds(const LfmOptions& o, const V* x, std::vector<V>& out) const {
    const V lower = broadcast3(double(o.lower)), upper = broadcast3(double(o.upper));
    for (size_t t = 0; t < out.size(); ++t) {
        const V value = x[t * terms_];
        const V none{}, one = broadcast3(1.0);
        out[t] = o.mu > 0 ? (value < lower ? -one : value > upper ? one : none) : none;
    }
}

SurfaceStep::SurfaceStep(const LfmVertex& vertex, const TileSmoothness& tiles)
    : vertex_(vertex), tiles_(tiles), first_group_(vertex.first_groups()) {
    const size_t terms = vertex.terms();
    steps_.reserve(vertex.maps());
    for (size_t map = 0; map < vertex.maps(); ++map)
        steps_.emplace_back(vertex.tile(map).texel_count(), surface_band(vertex.options, tiles.of(vertex.sides[map])),
                            terms);
    sums_.resize(vertex.largest_tile() * (terms * (terms + 1) / 2 + terms));
}

/// Sums over samples per texel; K = 0 where the number of terms isn't known beforehand.
template <int K>
void SurfaceStep::add_samples(size_t map, const V* p) {
    const size_t terms = K ? K : vertex_.terms(), products = terms * (terms + 1) / 2, width = products + terms;
    const V* view = p + vertex_.view_begin();
    std::fill(sums_.begin(), sums_.end(), V{});
    for (size_t group = first_group_[map]; group < first_group_[map + 1]; ++group) {
        const LfmVertex::Group& g = vertex_.groups[group];
        V h[max_terms];
        for (size_t k = 0; k < terms; ++k) {
            h[k] = V{};
            for (int j = 0; j < 4; ++j) h[k] += g.weight[j] * view[vertex_.corner(g, j) * terms + k];
        }
        for (uint32_t s = g.first; s < vertex_.groups[group + 1].first; ++s) {
            V* sum = &sums_[vertex_.local[s] * width];
            for (size_t k = 0, n = 0; k < terms; ++k) {
                for (size_t l = 0; l <= k; ++l, ++n) sum[n] += h[k] * h[l];
                sum[products + k] += h[k] * vertex_.target[s];
            }
        }
    }
    LaneCholesky& a = steps_[map].a();
    const double weight = vertex_.inverse_density;
    for (size_t t = 0; t < vertex_.tile(map).texel_count(); ++t) {
        const V* sum = &sums_[t * width];
        for (size_t k = 0, n = 0; k < terms; ++k) {
            for (size_t l = 0; l <= k; ++l, ++n) a.at(t * terms + k, t * terms + l) = weight * sum[n];
            steps_[map].b()[t * terms + k] = weight * sum[products + k];
        }
    }
}

bool SurfaceStep::operator()(V* p) {
    for (size_t map = 0; map < vertex_.maps(); ++map) {
        steps_[map].clear();
        with_terms(vertex_.options.terms, [&](auto k) { add_samples<k>(map, p); });
        steps_[map].add_smoothness(tiles_.of(vertex_.sides[map]), broadcast3(vertex_.lambda_surface));
        if (steps_[map].solve(vertex_.options, p + vertex_.map_begin(map)) != 0) return false;
    }
    return true;
}

ViewStep::ViewStep(const LfmVertex& vertex, const Smoothness& view)
    : vertex_(vertex),
      view_(view),
      step_(vertex.view->texel_count(), view_band(vertex.options, view), vertex.terms()),
      products_(vertex.terms() * (vertex.terms() + 1) / 2),
      sums_(vertex.terms()) {}

bool ViewStep::operator()(V* p) {
    const size_t terms = vertex_.terms();
    step_.clear();
    for (size_t i = 0; i + 1 < vertex_.groups.size(); ++i) {
        const LfmVertex::Group& g = vertex_.groups[i];
        std::fill(products_.begin(), products_.end(), V{});
        std::fill(sums_.begin(), sums_.end(), V{});
        for (uint32_t s = g.first; s < vertex_.groups[i + 1].first; ++s) {
            const V* surface = p + vertex_.map_begin(g.map) + vertex_.local[s] * terms;
            for (size_t k = 0, n = 0; k < terms; ++k) {
                for (size_t l = 0; l <= k; ++l, ++n) products_[n] += surface[k] * surface[l];
                sums_[k] += surface[k] * vertex_.target[s];
            }
        }
        add_view_sums<0>(vertex_, g, products_.data(), sums_.data(), step_.a(), step_.b().data());
    }
    step_.add_smoothness(view_, vertex_.lambda_view);
    return step_.solve(vertex_.options, p + vertex_.view_begin()) == 0;
}

}  // namespace radiafit::fits
