#pragma once
#include <type_traits>

#include "base/pack.h"
#include "cpu/lfm_objective.h"
#include "model/lfm_text.h"
#include "model/with_terms.h"

/// The two loops over samples (Eq. 12-13), written once for every way to hold them. View look-ups hoist: a kernel takes
/// the samples of one (vertex, image) between begin() and end(). Two samples share a register of twice four lanes; they
/// are of different texels, as every two samples of one image are.
///
/// Samples: size(); target(i), a lane per channel, the vertex's weight included; targets(i), those of i and i + 1;
/// texel(i), a place in the surface maps.
namespace radiafit {

/// Lower-left texel of a view look-up and the weights of (x0, y0), (x0+1, y0), (x0, y0+1), (x0+1, y0+1).
template <class real>
struct Footprint {
    uint32_t texel;
    real weight[4];
};

/// K terms; 0: as many as the shape says, at most max_terms.
template <class real, int K>
class LfmKernel {
protected:
    using V = Lanes<real>;
    using Pair = PairLanes<real>;
    using Text = LfmText<real, Pair>;
    static constexpr int most = K ? K : max_terms;

    LfmKernel(int terms, int view_side) : terms_(terms), row_(size_t(view_side) * size_t(terms)) {}
    int terms() const { return K ? K : terms_; }
    size_t corner(const Footprint<real>& f, int j) const {
        return size_t(f.texel) * size_t(terms()) + size_t(j & 1) * size_t(terms()) + (j & 2 ? row_ : 0);
    }
    /// Twice the same, for both samples of a pair.
    void look_up(const Footprint<real>& f, const V* view, Pair* h) const {
        for (int k = 0; k < terms(); ++k) {
            V sum{};
            for (int j = 0; j < 4; ++j) sum += f.weight[j] * view[corner(f, j) + size_t(k)];
            h[k] = join<real>(sum, sum);
        }
    }
    /// body(pair of places, pair of targets, whether there is a second sample): all samples, two by two. A missing
    /// second is at the first one's place with maps and a target of zero, so it adds nothing.
    template <class Samples, class Body>
    static void for_pairs(const Samples& samples, size_t terms, const Body& body) {
        const size_t count = samples.size();
        size_t i = 0;
        for (; i + 2 <= count; i += 2)
            body(size_t(samples.texel(i)) * terms, size_t(samples.texel(i + 1)) * terms, samples.targets(i),
                 std::true_type{});
        if (i < count) {
            const size_t at = size_t(samples.texel(i)) * terms;
            body(at, at, join<real>(samples.target(i), V{}), std::false_type{});
        }
    }
    template <class Two>
    static Pair load(const V* maps, size_t first, size_t second, Two) {
        if constexpr (Two::value) return join<real>(maps[first], maps[second]);
        return join<real>(maps[first], V{});
    }

private:
    int terms_;
    size_t row_;  ///< lanes of a view map's row
};

/// Sums of r^2 / 2 (or of the loss), of the gradient and, with Diagonal, of diag(J'J).
template <class real, int K, bool Diagonal, class Loss>
class DirectionKernel : LfmKernel<real, K> {
    using Base = LfmKernel<real, K>;
    using Base::corner, Base::terms;
    using Text = typename Base::Text;
    using Pair = typename Base::Pair;

public:
    using V = Lanes<real>;
    DirectionKernel(int terms, int view_side, Loss loss) : Base(terms, view_side), loss_(loss) {}

    /// weight: of the samples, in a loss that reweighs.
    void begin(const Footprint<real>& f, const V* view, [[maybe_unused]] real weight) {
        if constexpr (Loss::reweighs) weight_ = PackOf<real>(weight);
        Base::look_up(f, view, now_.h);
        now_.part = Pair{};
        for (int k = 0; k < terms(); ++k) now_.scatter[k] = now_.squares[k] = Pair{};
    }
    template <class Samples>
    void add(const Samples& samples, const V* surface, V* gradient, V* diagonal) {
        Sums s = now_;  // a copy stays in registers: no store through `gradient` can touch it
        Base::for_pairs(samples, size_t(terms()), [&](size_t first, size_t second, const Pair& target, auto two) {
            Pair r = -target;
            for (int k = 0; k < terms(); ++k) r += Text::lfm_value(Base::load(surface + k, first, second, two), s.h[k]);
            [[maybe_unused]] Pair weight;
            if constexpr (Loss::reweighs) {
                const PackOf<real> squared = weight_ * PackOf<real>(r * r);
                const PackOf<real> value = loss_.value(squared), factor = weight_ * loss_.weight(squared);
                s.part += value.joined();
                weight = factor.joined();
                r *= weight;
            } else {
                s.part += r * r;
            }
            const auto weighted = [&](const Pair& x) {
                if constexpr (Loss::reweighs) return Pair(weight * x);
                return x;
            };
            const auto accumulate = [&](V* sums, const Pair& x) {
                sums[first] += lower<real>(x);
                if constexpr (decltype(two)::value) sums[second] += upper<real>(x);
            };
            for (int k = 0; k < terms(); ++k) {
                const Pair g = Base::load(surface + k, first, second, two);
                accumulate(gradient + k, Text::lfm_gradient_surface(r, s.h[k]));
                s.scatter[k] += Text::lfm_gradient_view(r, g);
                if constexpr (Diagonal) {
                    accumulate(diagonal + k, weighted(s.h[k] * s.h[k]));
                    s.squares[k] += weighted(g * g);
                }
            }
        });
        now_ = s;
    }
    void end(const Footprint<real>& f, V* gradient, V* diagonal, Lanes<double>& error) const {
        error += 0.5 * widen<real>(fold<real>(now_.part));
        for (int k = 0; k < terms(); ++k)
            for (int j = 0; j < 4; ++j) {
                gradient[corner(f, j) + size_t(k)] += f.weight[j] * fold<real>(now_.scatter[k]);
                if constexpr (Diagonal)
                    diagonal[corner(f, j) + size_t(k)] += f.weight[j] * f.weight[j] * fold<real>(now_.squares[k]);
            }
    }

private:
    struct Sums {
        Pair h[Base::most], part, scatter[Base::most], squares[Base::most];
    };
    Sums now_;
    [[no_unique_address]] Loss loss_;
    PackOf<real> weight_{};
};

/// Sums along d: a^2, r b, a b, b^2 with r(alpha) = r + alpha a + alpha^2 b, each sample by its weight.
template <class real, int K, class Loss>
class LineKernel : LfmKernel<real, K> {
    using Base = LfmKernel<real, K>;
    using Base::terms;
    using Text = typename Base::Text;
    using Pair = typename Base::Pair;

public:
    using V = Lanes<real>;
    LineKernel(int terms, int view_side, Loss loss) : Base(terms, view_side), loss_(loss) {}

    void begin(const Footprint<real>& f, const V* view, const V* view_direction, [[maybe_unused]] real weight) {
        if constexpr (Loss::reweighs) weight_ = PackOf<real>(weight);
        Base::look_up(f, view, now_.h);
        Base::look_up(f, view_direction, now_.dh);
        for (Pair& sum : now_.sum) sum = Pair{};
    }
    template <class Samples>
    void add(const Samples& samples, const V* surface, const V* direction) {
        Sums s = now_;
        Base::for_pairs(samples, size_t(terms()), [&](size_t first, size_t second, const Pair& target, auto two) {
            Pair r = -target, a{}, b{};
            for (int k = 0; k < terms(); ++k) {
                const Pair g = Base::load(surface + k, first, second, two);
                const Pair dg = Base::load(direction + k, first, second, two);
                r += Text::lfm_value(g, s.h[k]);
                a += Text::lfm_slope(g, s.h[k], dg, s.dh[k]);
                b += Text::lfm_bend(dg, s.dh[k]);
            }
            if constexpr (Loss::reweighs) {
                const PackOf<real> squared = weight_ * PackOf<real>(r * r);
                const Pair root = sqrt(weight_ * loss_.weight(squared)).joined();
                r *= root, a *= root, b *= root;
            }
            s.sum[0] += a * a;
            s.sum[1] += r * b;
            s.sum[2] += a * b;
            s.sum[3] += b * b;
        });
        now_ = s;
    }
    void end(LineLanes& line) const {
        const auto sum = [&](int which) { return widen<real>(fold<real>(now_.sum[which])); };
        line.gauss_newton += sum(0);
        line.curvature += sum(0) + 2.0 * sum(1);
        line.third += sum(2);
        line.fourth += sum(3);
    }

private:
    struct Sums {
        Pair h[Base::most], dh[Base::most], sum[4];
    };
    Sums now_;
    [[no_unique_address]] Loss loss_;
    PackOf<real> weight_{};
};

/// body(terms, loss): K of the kernels where it is compiled in, and the loss of the fit.
template <class Body>
void with_kernels(const LfmOptions& options, const Body& body) {
    with_loss(options.loss, [&](auto loss) {
        if constexpr (decltype(loss)::reweighs)
            body(std::integral_constant<int, 0>{}, loss);
        else
            with_terms(options.terms, [&](auto terms) { body(terms, loss); });
    });
}

}  // namespace radiafit
