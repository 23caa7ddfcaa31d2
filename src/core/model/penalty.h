#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/lanes.h"
#include "model/lfm.h"
#include "model/prelude.h"

/// E_r (Eq. 9) and E_b (Section 3.1), on maps stored [texel][term] of lanes.
namespace radiafit {

namespace shared_text {
using std::max, std::min, radiafit::max;
template <class real_type, class V>
struct Objective {
    using real = real_type;
    using element = V;
    static element where(const element& condition, const element& a, const element& b) {
        return select_nonzero(condition, a, b);
    }
#include "model/bounds.glsl"
//
#include "model/precondition.glsl"
};
}  // namespace shared_text

/// Texts of the objective that every family and device shares: bounds of parameters, the floor of the preconditioner.
/// `V`: a number, or several side by side.
template <class real, class V = real>
using ObjectiveText = shared_text::Objective<real, V>;

/// The four-neighbourhood inside one map; what lies outside is left out and the centre weight is the number kept, so
/// L is symmetric and its rows sum to zero.
class MapNeighbours {
public:
    /// A TriangleTile's. Throws UserError for a side that it doesn't have. It lives as long as the program.
    static const MapNeighbours& triangle(int side);
    static MapNeighbours square(int side);  ///< m x m, row by row
    size_t texel_count() const { return count_.size(); }
    std::span<const uint16_t> of(size_t texel) const { return {neighbours_[texel].data(), count_[texel]}; }

    /// y = L x for term k of a map of `terms` terms. x [texel][term], y [texel].
    template <class real>
    void apply(const Lanes<real>* x, int terms, int k, Lanes<real>* y) const {
        const auto at = [&](size_t texel) { return x[texel * size_t(terms) + size_t(k)]; };
        for (size_t i = 0; i < texel_count(); ++i) {
            const auto& [a, b, c, d] = neighbours_[i];
            y[i] = ((at(i) - at(a)) + (at(i) - at(b))) + ((at(i) - at(c)) + (at(i) - at(d)));
        }
    }

private:
    template <class Inside>
    static MapNeighbours make(int side, const Inside& local_of);
    std::vector<std::array<uint16_t, 4>> neighbours_;  ///< [texels] its neighbours, then itself
    std::vector<uint8_t> count_;                       ///< [texels] neighbours
};

/// lambda E_r: adds lambda/2 |L x|^2 to error and lambda L'L x to g. scratch [2 * texels].
template <class real>
void add_smoothness(const MapNeighbours& map, int terms, Lanes<real> lambda, const Lanes<real>* x, Lanes<real>* g,
                    Lanes<double>& error, Lanes<real>* scratch) {
    const size_t n = map.texel_count();
    Lanes<real>* once = scratch;
    Lanes<real>* twice = scratch + n;
    for (int k = 0; k < terms; ++k) {
        map.apply<real>(x, terms, k, once);
        map.apply<real>(once, 1, 0, twice);
        Lanes<real> sum{};
        for (size_t i = 0; i < n; ++i) {
            sum += once[i] * once[i];
            g[i * terms + k] += lambda * twice[i];
        }
        error += 0.5 * widen<real>(lambda * sum);
    }
}

/// The second derivative of lambda E_r along d: lambda |L d|^2. scratch [texels].
template <class real>
Lanes<real> smoothness_curvature(const MapNeighbours& map, int terms, Lanes<real> lambda, const Lanes<real>* d,
                                 Lanes<real>* scratch) {
    Lanes<real> sum{};
    for (int k = 0; k < terms; ++k) {
        map.apply<real>(d, terms, k, scratch);
        for (size_t i = 0; i < map.texel_count(); ++i) sum += scratch[i] * scratch[i];
    }
    return lambda * sum;
}

/// body(texel, channel, value) for what is out of bounds, or not a number, in the first term.
template <class real, class Body>
void for_beyond_bounds(const LfmOptions& o, size_t texels, const Lanes<real>* x, const Body& body) {
    const real a = o.lower, b = o.upper;
    const auto within = [&](real value) { return value >= a && value <= b; };
    for (size_t i = 0; i < texels; ++i) {
        const Lanes<real>& values = x[i * size_t(o.terms)];
        if (within(values[0]) & within(values[1]) & within(values[2])) continue;
        for (int c = 0; c < 3; ++c)
            if (!within(values[c])) body(i, c, values[c]);
    }
}

/// mu E_b on the first term.
template <class real>
void add_bounds(const LfmOptions& o, size_t texels, const Lanes<real>* x, Lanes<real>* g, Lanes<double>& error) {
    const real a = o.lower, b = o.upper, mu = o.mu;
    for_beyond_bounds<real>(o, texels, x, [&](size_t i, int c, real value) {
        error[c] += ObjectiveText<real>::bound_error(value, a, b, mu, o.mode == Mode::paper);
        g[i * size_t(o.terms)][c] += ObjectiveText<real>::bound_slope(value, a, b, mu, o.mode == Mode::paper);
    });
}

/// The second derivative of mu E_b along d, at x.
template <class real>
Lanes<real> bounds_curvature(const LfmOptions& o, size_t texels, const Lanes<real>* x, const Lanes<real>* d) {
    Lanes<real> sum{};
    for_beyond_bounds<real>(o, texels, x, [&](size_t i, int c, real value) {
        const real along = d[i * size_t(o.terms)][c];
        sum[c] += ObjectiveText<real>::bound_curvature(value, along, o.lower, o.upper, o.mu, o.mode == Mode::paper);
    });
    return sum;
}

/// lambda E_r + mu E_b of the problems of vertex v [3], for parameters p in the layout's order. mean [3]: of L t, which
/// scales the view map's weight.
/// view: neighbours in it.
std::array<double, 3> penalty_error(const LfmLayout& layout, const LfmOptions& options, const MapNeighbours& view,
                                    size_t v, std::span<const float> p, std::span<const float> mean);

}  // namespace radiafit
