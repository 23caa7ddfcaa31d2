#pragma once
#include <array>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "base/jet.h"

/// Reflectance models whose problems are single texels. For each colour channel c
///     m_c = sum_k a[k][c] basis_k(terms; shape),
/// where the last basis functions depend on the shape, which the channels share: one of them, or as many as the text
/// says (SHAPED_COUNT). `Text` is a model's shared text (shaders/model/NAME.glsl); docs/texel-models.md lists what one
/// holds. The texts that there are: model/texel_texts.h, made from the list in src/core/model/CMakeLists.txt. A text of
/// several lobes says by shape_owner() which basis function each number of the shape belongs to; Levenberg-Marquardt on
/// the CPU alone fits those (cpu/texel_fit.h).
///
/// Parameters of a texel: a[basis][3], then the shape: Lafortune's rho_d, rho_s, Cx, Cz, log n (Eq. 16).
namespace radiafit {

/// Whether a parameter's bounds are meant, rather than as far as floats go.
constexpr bool are_meant(const std::array<double, 2>& bounds) { return bounds[1] - bounds[0] < 1e29; }

/// A radiance sample of one texel: a pixel of one image. One weight, shared by the channels, >= 0.
template <int terms>
struct TexelSample {
    std::array<float, size_t(terms)> term;  ///< sample_terms() of the text
    std::array<float, 3> target;
    float weight = 1;
};

/// Says by name what a text lacks.
template <class Text>
struct CompleteText {
    static_assert(
        requires {
            typename Text::Terms;
            typename Text::Basis;
            typename Text::Shape;
        },
        "a texel model's text must define the structs Terms, Basis and Shape");
    static_assert(
        requires(typename Text::real3 u) {
            { Text::sample_terms(u, u) } -> std::same_as<typename Text::Terms>;
        },
        "a texel model's text must define Terms sample_terms(real3 u, real3 v)");
    static_assert(
        requires(typename Text::Shape s, typename Text::Terms t) {
            { Text::basis(s, t) } -> std::same_as<typename Text::Basis>;
        },
        "a texel model's text must define Basis basis(Shape, Terms)");
    static_assert(
        requires { Text::coefficient_names[Text::basis_count - 1]; },
        "a texel model's text must define coefficient_names[BASIS_COUNT]");
    static constexpr bool bounds_fit = [] {
        if constexpr (requires { Text::coefficient_bounds; }) {
            using Table = std::remove_cvref_t<decltype(Text::coefficient_bounds)>;
            const bool of_all = std::rank_v<Table> == 2 && std::extent_v<Table, 1> == 2;
            const bool of_each =
                std::rank_v<Table> == 3 && std::extent_v<Table, 1> == 3 && std::extent_v<Table, 2> == 2;
            return std::extent_v<Table> >= size_t(Text::basis_count) && (of_all || of_each);
        }
        return false;
    }();
    static_assert(bounds_fit,
                  "a texel model's text must define coefficient_bounds[BASIS_COUNT][2], or of each channel its own: "
                  "coefficient_bounds[BASIS_COUNT][3][2]");
    static constexpr bool no_shape = Text::shape_count == 0;
    static constexpr int shaped = [] {
        if constexpr (requires { Text::shaped_count; }) return Text::shaped_count;
        return 1;
    }();
    static_assert(no_shape || (shaped >= 1 && shaped <= Text::basis_count),
                  "a texel model's SHAPED_COUNT must be from 1 to BASIS_COUNT");
    static constexpr bool several_lobes = requires { Text::shape_owner(0); };
    static_assert(
        no_shape || !several_lobes ||
            requires(typename Text::Shape s, typename Text::Terms t) { Text::shape_slope(s, t); },
        "a texel model of several lobes must define Slope shape_slope(Shape, Terms)");
    static_assert(
        no_shape ||
            requires {
                Text::shape_names[0];
                Text::shape_bounds[0][1];
            },
        "a texel model with a shape must define shape_names[SHAPE_COUNT] and shape_bounds[SHAPE_COUNT][2]");
    static_assert(
        no_shape || several_lobes || requires { Text::starts[Text::start_count - 1][0]; },
        "a texel model with a shape must define start_count and starts[start_count][SHAPE_COUNT]");
    static constexpr bool gauge = requires { Text::gauge_count; };
    static_assert(
        !gauge ||
            requires(typename Text::Shape s) {
                Text::fix_gauge(s);
                Text::gauge_tangent(s);
            },
        "a texel model with gauge_count must define real fix_gauge(Shape&) and Shape gauge_tangent(Shape)");
    static_assert(no_shape || shaped == 1 ||
                      !(
                          gauge || several_lobes ||
                          requires(typename Text::Shape s, typename Text::Terms t) { Text::shape_slope(s, t); } ||
                          requires(typename Text::Shape s, typename Text::Terms t) { Text::shape_bend(s, s, t); }),
                  "a texel model with SHAPED_COUNT above 1 defines no shape_slope, shape_bend or gauge_count");
};

template <class Text>
struct TexelLocal : CompleteText<Text> {
    using real = typename Text::real;
    using Terms = typename Text::Terms;
    static constexpr int basis = Text::basis_count, shape = Text::shape_count;
    static constexpr int parameters = 3 * basis + shape;
    static constexpr bool several_lobes = CompleteText<Text>::several_lobes;
    /// How many basis functions depend on the shape, the last ones; where each number of it has an owner, so does that.
    static constexpr int shaped = shape == 0 ? 0 : several_lobes ? 1 : CompleteText<Text>::shaped;
    /// Derivatives of a basis function by a number of the shape, which is slope_shape() of slope_basis().
    static constexpr int slopes = shaped * shape;
    static constexpr int shared = basis + slopes;  ///< columns of the Jacobian that the channels share but for a factor
    /// In how many directions a shape moves without effect, if the last coefficients move too.
    static constexpr int gauge_count = [] {
        if constexpr (CompleteText<Text>::gauge) return Text::gauge_count;
        return 0;
    }();
    /// So many samples a texel needs at least: as many as a channel has coefficients, and numbers of the shape, that
    /// aren't held, less the gauge.
    static constexpr int independent() {
        int most = 0, of_shape = 0;
        for (int c = 0; c < 3; ++c) {
            int free = 0;
            for (int k = 0; k < basis; ++k) free += !held(3 * k + c);
            most = free > most ? free : most;
        }
        for (int i = 3 * basis; i < parameters; ++i) of_shape += !held(i);
        return most + of_shape - gauge_count;
    }
    using Parameters = std::array<real, size_t(parameters)>;

    static constexpr int slope_basis(int slope) {
        if constexpr (several_lobes) return Text::shape_owner(slope);
        return basis - shaped + slope / (shape > 0 ? shape : 1);
    }
    static constexpr int slope_shape(int slope) { return slope % (shape > 0 ? shape : 1); }
    static typename Text::Shape shape_of(const Parameters& p) {
        typename Text::Shape s{};
        for (int i = 0; i < shape; ++i) s.x[i] = p[size_t(3 * basis + i)];
        return s;
    }
    static std::array<real, 3> value(const Parameters& p, const Terms& t) {
        const auto b = Text::basis(shape_of(p), t);
        std::array<real, 3> m{};
        for (size_t c = 0; c < 3; ++c)
            for (int k = 0; k < basis; ++k) m[c] += p[size_t(3 * k) + c] * b.x[k];
        return m;
    }
    /// Gradient of each shaped basis function by the shape, in slopes' order: the text's, or else by numbers that carry
    /// derivatives.
    static auto shape_slope(const typename Text::Shape& s, const Terms& t) {
        if constexpr (requires { Text::shape_slope(s, t); }) {
            return Text::shape_slope(s, t);
        } else {
            using Number = Jet<real, shape>;
            using Made = typename Text::template with<Number>;
            typename Made::Shape numbers;
            for (int i = 0; i < shape; ++i) {
                numbers.x[i] = Number(s.x[i]);
                numbers.x[i].d[i] = real(1.0);
            }
            const typename Made::Basis b = Made::basis(numbers, constants<Made>(t));
            struct {
                real x[slopes];
            } out;
            for (int i = 0; i < slopes; ++i) out.x[i] = b.x[slope_basis(i)].d[slope_shape(i)];
            return out;
        }
    }
    /// First and second derivative of each along d, likewise.
    static auto shape_bends(const typename Text::Shape& s, const typename Text::Shape& d, const Terms& t) {
        using Bends = std::array<typename Text::real2, size_t(shaped)>;
        if constexpr (requires { Text::shape_bend(s, d, t); }) {
            return Bends{Text::shape_bend(s, d, t)};
        } else {
            using First = Jet<real, 1>;
            using Number = Jet<First, 1>;
            using Made = typename Text::template with<Number>;
            typename Made::Shape numbers;
            for (int i = 0; i < shape; ++i) {
                First x(s.x[i]);
                x.d[0] = d.x[i];
                numbers.x[i] = Number(x);
                numbers.x[i].d[0] = First(d.x[i]);
            }
            const typename Made::Basis b = Made::basis(numbers, constants<Made>(t));
            const auto of = [&](size_t l) {
                const Number& x = b.x[basis - shaped + int(l)];
                return typename Text::real2(x.v.d[0], x.d[0].d[0]);
            };
            return [&]<size_t... l>(std::index_sequence<l...>) { return Bends{of(l)...}; }
            (std::make_index_sequence<size_t(shaped)>());
        }
    }
    /// Row c of the Jacobian is nonzero at a[k][c], where it is column k, and at the shape's numbers, where it is the
    /// sum of their slopes: a[slope_basis(j)][c] times column basis + j.
    static std::array<real, size_t(shared)> columns(const typename Text::Shape& s, const Terms& t) {
        const auto b = Text::basis(s, t);
        std::array<real, size_t(shared)> q;
        for (int k = 0; k < basis; ++k) q[size_t(k)] = b.x[k];
        if constexpr (shape > 0) {
            const auto slope = shape_slope(s, t);
            for (int i = 0; i < slopes; ++i) q[size_t(basis + i)] = slope.x[i];
        }
        return q;
    }
    /// First and second derivative of the value along d.
    struct Bend {
        std::array<real, 3> first, second;
    };
    static Bend bend(const Parameters& p, const Parameters& d, const Terms& t) {
        static_assert(!CompleteText<Text>::several_lobes);
        const auto s = shape_of(p);
        const auto b = Text::basis(s, t);
        Bend out{};
        for (size_t c = 0; c < 3; ++c)
            for (int k = 0; k < basis; ++k) out.first[c] += d[size_t(3 * k) + c] * b.x[k];
        if constexpr (shape > 0) {
            const auto along = shape_bends(s, shape_of(d), t);
            for (size_t l = 0; l < along.size(); ++l)
                for (size_t c = 0; c < 3; ++c) {
                    const size_t lobe = 3 * (size_t(basis - shaped) + l) + c;
                    const real second = real(2) * d[lobe] * along[l].x + p[lobe] * along[l].y;
                    out.first[c] += p[lobe] * along[l].x;
                    out.second[c] = l == 0 ? second : out.second[c] + second;
                }
        }
        return out;
    }

    /// Terms as numbers that no parameter enters.
    template <class Made>
    static typename Made::Terms constants(const Terms& t) {
        typename Made::Terms out;
        for (int k = 0; k < Text::term_count; ++k) out.x[k] = typename Made::real(t.x[k]);
        return out;
    }

    /// Lowest and highest value of parameter i.
    static constexpr std::array<double, 2> bounds(int i) {
        if constexpr (shape > 0)
            if (i >= 3 * basis) return {Text::shape_bounds[i - 3 * basis][0], Text::shape_bounds[i - 3 * basis][1]};
        const auto& of = channel_bounds(size_t(i % 3))[i / 3];
        return {of[0], of[1]};
    }
    static constexpr bool bounded(int i) { return are_meant(bounds(i)); }
    /// Of the coefficients of channel c, in the order of the basis functions. A text gives all channels the same, or
    /// each its own.
    static constexpr const double (&channel_bounds([[maybe_unused]] size_t c))[basis][2] {
        if constexpr (bounds_by_channel)
            return by_channel.at[c];
        else
            return Text::coefficient_bounds;
    }
    /// Whether parameter i stays where its bounds meet.
    static constexpr bool held(int i) { return bounds(i)[0] == bounds(i)[1]; }
    static constexpr bool any_held() {
        for (int i = 0; i < parameters; ++i)
            if (held(i)) return true;
        return false;
    }
    /// Coefficient k of channel c where nothing is known of it: 0, as far as its bounds let it.
    static constexpr double least(size_t k, size_t c) {
        const auto& of = channel_bounds(c)[k];
        return of[0] > 0 ? of[0] : of[1] < 0 ? of[1] : 0;
    }
    static constexpr bool coefficients_may_be_zero() {
        for (int i = 0; i < 3 * basis; ++i)
            if (least(size_t(i / 3), size_t(i % 3)) != 0) return false;
        return true;
    }
    /// The same values by other parameters: the only gauge in which two of them may be compared.
    static Parameters canonical(Parameters p) {
        if constexpr (gauge_count > 0) {
            auto s = shape_of(p);
            const real factor = Text::fix_gauge(s);
            for (size_t c = 0; c < 3; ++c) p[size_t(3 * (basis - 1)) + c] = p[size_t(3 * (basis - 1)) + c] * factor;
            for (int i = 0; i < shape; ++i) p[size_t(3 * basis + i)] = s.x[i];
        }
        return p;
    }

private:
    static constexpr bool bounds_by_channel = std::rank_v<std::remove_cvref_t<decltype(Text::coefficient_bounds)>> == 3;
    struct ByChannel {
        double at[3][basis][2];
    };
    static constexpr ByChannel by_channel = [] {
        ByChannel out{};
        if constexpr (bounds_by_channel)
            for (int k = 0; k < basis; ++k)
                for (int c = 0; c < 3; ++c)
                    for (int i = 0; i < 2; ++i) out.at[c][k][i] = Text::coefficient_bounds[k][c][i];
        return out;
    }();
};

}  // namespace radiafit
