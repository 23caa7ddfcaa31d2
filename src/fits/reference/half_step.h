#pragma once
#include <optional>
#include <vector>

#include "reference/lane_cholesky.h"
#include "reference/lfm_vertex.h"

/// Minimizers of E_t over one kind of map while the other stays: quadratic there, but for the bounds.
namespace radiafit::fits {

/// L'L of one kind of map, lower triangle.
struct Smoothness {
    struct Entry {
        uint32_t row, column;
        double value;
    };
    std::vector<Entry> entries;
    size_t band = 0;  ///< texels

    explicit Smoothness(const MapNeighbours& map);
};

/// The smoothness of surface maps, for each side that a fit has.
class TileSmoothness {
public:
    explicit TileSmoothness(const LfmOptions& model);
    const Smoothness& of(int side) const { return *of_side_[size_t(side)]; }

private:
    std::vector<std::optional<Smoothness>> of_side_;
};

/// Band of E_t's second derivative in a surface map, in parameters, and in the view map: of texels that L'L couples, or
/// that are corners of one look-up, all terms with all.
size_t surface_band(const LfmOptions& model, const Smoothness& tile);
size_t view_band(const LfmOptions& model, const Smoothness& view);

/// Minimizes 1/2 x'Ax - b'x + mu E_b(x) over one map's x [texel][term] (first terms bounded).
class HalfStep {
public:
    using V = Lanes<double>;
    HalfStep(size_t texels, size_t band, size_t terms);

    void clear();
    LaneCholesky& a() { return a_; }
    std::vector<V>& b() { return b_; }
    void add_smoothness(const Smoothness& s, V lambda);
    /// x holds the present values. Bit c of the result: lane c's A isn't positive definite; no lane of x is changed
    /// then.
    unsigned solve(const LfmOptions& o, V* x);
    /// The factor of A with the bounds that the last solution is beyond.
    const LaneCholesky& factor() const { return factor_; }

private:
    /// -1 below the lower bound, 1 above the upper, else 0.
    void beyond_bounds(const LfmOptions& o, const V* x, std::vector<V>& out) const;

    size_t terms_;
    LaneCholesky a_, factor_;
    std::vector<V> b_, solution_, active_, next_;
};

/// What one group's samples add to the view map's part of E_t: to its second derivative a, and to a vector b in the
/// view map's order.
/// products: sums over samples of g_k g_l, l <= k, row after row. sums [term]: of g_k times what b is about.
/// K = 0 where the number of terms isn't known beforehand.
template <int K>
void add_view_sums(const LfmVertex& vertex, const LfmVertex::Group& group, const Lanes<double>* products,
                   const Lanes<double>* sums, LaneCholesky& a, Lanes<double>* b) {
    const size_t terms = K ? K : vertex.terms();
    // Two corners of a look-up share products in both orders of k and l.
    const auto place = [](size_t k, size_t l) { return k >= l ? k * (k + 1) / 2 + l : l * (l + 1) / 2 + k; };
    for (int x = 0; x < 4; ++x) {
        const size_t row = vertex.corner(group, x) * terms;
        for (size_t k = 0; k < terms; ++k) {
            b[row + k] += group.weight[x] * vertex.inverse_density * sums[k];
            for (int y = 0; y <= x; ++y) {
                const size_t column = vertex.corner(group, y) * terms;
                const double weight = group.weight[x] * group.weight[y] * vertex.inverse_density;
                for (size_t l = 0; l < (y < x ? terms : k + 1); ++l)
                    a.at(row + k, column + l) += weight * products[place(k, l)];
            }
        }
    }
}

/// All surface maps of a vertex, given its view map.
class SurfaceStep {
public:
    using V = Lanes<double>;
    SurfaceStep(const LfmVertex& vertex, const TileSmoothness& tiles);

    /// The surface maps of p are overwritten. False where a map's system can't be solved.
    bool operator()(V* p);
    const LaneCholesky& factor(size_t map) const { return steps_[map].factor(); }

private:
    template <int K>
    void add_samples(size_t map, const V* p);

    const LfmVertex& vertex_;
    const TileSmoothness& tiles_;
    std::vector<size_t> first_group_;  ///< [maps + 1]
    std::vector<HalfStep> steps_;      ///< [maps]
    std::vector<V> sums_;              ///< [texels][products of terms, then terms]
};

/// The view map of a vertex, given its surface maps.
class ViewStep {
public:
    using V = Lanes<double>;
    ViewStep(const LfmVertex& vertex, const Smoothness& view);
    bool operator()(V* p);

private:
    const LfmVertex& vertex_;
    const Smoothness& view_;
    HalfStep step_;
    std::vector<V> products_, sums_;
};

}  // namespace radiafit::fits
