#pragma once
#include <type_traits>

#include "cpu/lfm_objective.h"
#include "model/lfm_text.h"

/// The two loops over samples (Eq. 12-13), written once for every way to hold them. View look-ups hoist: a kernel takes
/// the samples of one (vertex, image) between begin() and end(). Two samples go side by side, so that their sums don't
/// wait for one another; they are of different texels, as every two samples of one image are.
///
/// Samples: size(); target(i), a lane per channel, the vertex's weight included; texel(i), a place in the surface maps
/// that surface() and surface_gradient() address.
namespace radiafit {

/// Lower-left texel of a view look-up and the weights of (x0, y0), (x0+1, y0), (x0, y0+1), (x0+1, y0+1).
template <class real>
struct Footprint {
    uint32_t texel;
    real weight[4];
};

/// Calls body(integral_constant K) with K = terms where that is 1, 2 or 3, else K = 0: a count known at run time only.
template <class Body>
void with_terms(int terms, const Body& body) {
    switch (terms) {
        case 1:
            return body(std::integral_constant<int, 1>{});
        case 2:
            return body(std::integral_constant<int, 2>{});
        case 3:
            return body(std::integral_constant<int, 3>{});
        default:
            return body(std::integral_constant<int, 0>{});
    }
}

/// K terms; 0: as many as the shape says, at most 16.
template <class real, int K>
class LfmKernel {
protected:
    using V = Lanes<real>;
    using Text = LfmText<real, V>;
    static constexpr int most = K ? K : 16;

    LfmKernel(int terms, int view_side) : terms_(terms), row_(size_t(view_side) * size_t(terms)) {}
    int terms() const { return K ? K : terms_; }
    size_t corner(const Footprint<real>& f, int j) const {
        return size_t(f.texel) * size_t(terms()) + size_t(j & 1) * size_t(terms()) + (j & 2 ? row_ : 0);
    }
    void look_up(const Footprint<real>& f, const V* view, V* h) const {
        for (int k = 0; k < terms(); ++k) {
            h[k] = V{};
            for (int j = 0; j < 4; ++j) h[k] += f.weight[j] * view[corner(f, j) + size_t(k)];
        }
    }

private:
    int terms_;
    size_t row_;  ///< lanes of a view map's row
};

/// Sums of r^2 / 2, of the gradient and, with Diagonal, of diag(J'J).
template <class real, int K, bool Diagonal>
class DirectionKernel : LfmKernel<real, K> {
    using Base = LfmKernel<real, K>;
    using Base::corner, Base::terms;
    using Text = typename Base::Text;

public:
    using V = Lanes<real>;
    DirectionKernel(int terms, int view_side) : Base(terms, view_side) {}

    void begin(const Footprint<real>& f, const V* view) {
        Base::look_up(f, view, now_.h);
        for (int side = 0; side < 2; ++side) {
            now_.part[side] = V{};
            for (int k = 0; k < terms(); ++k) now_.scatter[side][k] = now_.squares[side][k] = V{};
        }
    }
    template <class Samples>
    void add(const Samples& samples, const V* surface, V* gradient, V* diagonal) {
        Sums s = now_;  // a copy stays in registers: no store through `gradient` can touch it
        const size_t count = samples.size();
        size_t i = 0;
        for (; i + 2 <= count; i += 2) {
            one<0>(s, samples, i, surface, gradient, diagonal);
            one<1>(s, samples, i + 1, surface, gradient, diagonal);
        }
        if (i < count) one<0>(s, samples, i, surface, gradient, diagonal);
        now_ = s;
    }
    void end(const Footprint<real>& f, V* gradient, V* diagonal, Lanes<double>& error) const {
        error += 0.5 * widen<real>(now_.part[0] + now_.part[1]);
        for (int k = 0; k < terms(); ++k)
            for (int j = 0; j < 4; ++j) {
                gradient[corner(f, j) + size_t(k)] += f.weight[j] * (now_.scatter[0][k] + now_.scatter[1][k]);
                if constexpr (Diagonal)
                    diagonal[corner(f, j) + size_t(k)] +=
                        f.weight[j] * f.weight[j] * (now_.squares[0][k] + now_.squares[1][k]);
            }
    }

private:
    struct Sums {
        V h[Base::most], part[2], scatter[2][Base::most], squares[2][Base::most];
    };
    template <int side, class Samples>
    void one(Sums& s, const Samples& samples, size_t i, const V* surface, V* gradient, V* diagonal) const {
        const size_t at = size_t(samples.texel(i)) * size_t(terms());
        V r = -samples.target(i);
        for (int k = 0; k < terms(); ++k) r += Text::lfm_value(surface[at + size_t(k)], s.h[k]);
        s.part[side] += r * r;
        for (int k = 0; k < terms(); ++k) {
            const V g = surface[at + size_t(k)];
            gradient[at + size_t(k)] += Text::lfm_gradient_surface(r, s.h[k]);
            s.scatter[side][k] += Text::lfm_gradient_view(r, g);
            if constexpr (Diagonal) {
                diagonal[at + size_t(k)] += s.h[k] * s.h[k];
                s.squares[side][k] += g * g;
            }
        }
    }
    Sums now_;
};

/// Sums along d: a^2, r b, a b, b^2 with r(alpha) = r + alpha a + alpha^2 b.
template <class real, int K>
class LineKernel : LfmKernel<real, K> {
    using Base = LfmKernel<real, K>;
    using Base::terms;
    using Text = typename Base::Text;

public:
    using V = Lanes<real>;
    LineKernel(int terms, int view_side) : Base(terms, view_side) {}

    void begin(const Footprint<real>& f, const V* view, const V* view_direction) {
        Base::look_up(f, view, now_.h);
        Base::look_up(f, view_direction, now_.dh);
        for (auto& side : now_.sum)
            for (V& sum : side) sum = V{};
    }
    template <class Samples>
    void add(const Samples& samples, const V* surface, const V* direction) {
        Sums s = now_;
        const size_t count = samples.size();
        size_t i = 0;
        for (; i + 2 <= count; i += 2) {
            one<0>(s, samples, i, surface, direction);
            one<1>(s, samples, i + 1, surface, direction);
        }
        if (i < count) one<0>(s, samples, i, surface, direction);
        now_ = s;
    }
    void end(LineLanes& line) const {
        const auto sum = [&](int which) { return widen<real>(now_.sum[0][which] + now_.sum[1][which]); };
        line.gauss_newton += sum(0);
        line.curvature += sum(0) + 2.0 * sum(1);
        line.third += sum(2);
        line.fourth += sum(3);
    }

private:
    struct Sums {
        V h[Base::most], dh[Base::most], sum[2][4];
    };
    template <int side, class Samples>
    void one(Sums& s, const Samples& samples, size_t i, const V* surface, const V* direction) const {
        const size_t at = size_t(samples.texel(i)) * size_t(terms());
        V r = -samples.target(i), a{}, b{};
        for (int k = 0; k < terms(); ++k) {
            const V g = surface[at + size_t(k)], dg = direction[at + size_t(k)];
            r += Text::lfm_value(g, s.h[k]);
            a += Text::lfm_slope(g, s.h[k], dg, s.dh[k]);
            b += Text::lfm_bend(dg, s.dh[k]);
        }
        s.sum[side][0] += a * a;
        s.sum[side][1] += r * b;
        s.sum[side][2] += a * b;
        s.sum[side][3] += b * b;
    }
    Sums now_;
};

}  // namespace radiafit
