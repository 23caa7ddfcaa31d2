#pragma once
#include "cpu/texel_batch.h"
#include "model/small_solve.h"

/// The loops over samples of texel-local models, a lane per texel.
namespace radiafit {

/// With residuals r_c = m_c - target_c and columns q (TexelLocal::columns), per lane:
///     shared [i][j] = sum w q_i q_j           lower triangle: 15 of Lafortune
///     linear [i][c] = sum w q_i r_c           15; coefficients' gradient, and per channel what makes the shape's
///     error         = 1/2 sum w r_c^2         1
/// The gradient by shape i is sum_c a[last][c] linear[B + i][c]. Keeping its three parts apart (9 + 1 sums would do for
/// plain Levenberg-Marquardt) lets the coefficients, which are linear, be solved exactly after every sweep.
/// Floats over 64 samples at a time, doubles beyond.
template <class Text>
struct TexelSums {
    static constexpr int B = Text::basis_count, C = B + Text::shape_count;
    SmallMatrix<WidePack, C> shared;
    std::array<std::array<WidePack, 3>, size_t(C)> linear;
    WidePack error;
};

namespace detail {
/// Calls body on runs of rows short enough for sums in floats.
template <class Row, class Body>
void for_runs(std::span<const Row> rows, const Body& body) {
    constexpr size_t run = 64;
    for (size_t i = 0; i < rows.size(); i += run) body(rows.subspan(i, std::min(run, rows.size() - i)));
}
template <class Text>
typename Text::Terms terms_of(const typename TexelBatch<Text::term_count>::Row& row) {
    typename Text::Terms t;
    for (int k = 0; k < Text::term_count; ++k) t.x[k] = row.term[k];
    return t;
}
}  // namespace detail

/// `Text`: a model's text with real = Pack. p: TexelLocal's parameters, a lane per texel.
template <class Text>
TexelSums<Text> texel_sums(std::span<const typename TexelBatch<Text::term_count>::Row> rows,
                           const typename TexelLocal<Text>::Parameters& p) {
    using Model = TexelLocal<Text>;
    constexpr size_t B = size_t(Model::basis), C = size_t(Model::shared);
    const typename Text::Shape shape = Model::shape_of(p);
    TexelSums<Text> out{};
    detail::for_runs(rows, [&](auto run) {
        Pack shared[C * (C + 1) / 2], linear[C][3], error;
        for (const auto& row : run) {
            const auto q = Model::columns(shape, detail::terms_of<Text>(row));
            Pack r[3], squares;
            for (size_t c = 0; c < 3; ++c) {
                r[c] = p[c] * q[0] - row.target[c];
                for (size_t k = 1; k < B; ++k) r[c] += p[3 * k + c] * q[k];
                squares += r[c] * r[c];
            }
            error += row.weight * squares;
            for (size_t i = 0, at = 0; i < C; ++i) {
                const Pack weighted = row.weight * q[i];
                for (size_t c = 0; c < 3; ++c) linear[i][c] += weighted * r[c];
                for (size_t j = 0; j <= i; ++j) shared[at++] += weighted * q[j];
            }
        }
        for (size_t i = 0, at = 0; i < C; ++i) {
            for (size_t j = 0; j <= i; ++j) out.shared[i][j] += widen(shared[at++]);
            for (size_t c = 0; c < 3; ++c) out.linear[i][c] += widen(linear[i][c]);
        }
        out.error += WidePack(0.5) * widen(error);
    });
    return out;
}

/// What a linear fit of the coefficients needs at each of `Text::starts`: those basis functions that don't depend on
/// the shape are summed once.
template <class Text>
struct StartSums {
    static constexpr size_t B = size_t(Text::basis_count), count = size_t(Text::start_count);
    SmallMatrix<WidePack, Text::basis_count> plain;          ///< sum w b_i b_j, i, j < B - 1
    std::array<std::array<WidePack, 3>, B> target;           ///< sum w b_i target_c, i < B - 1
    WidePack squares;                                        ///< sum w target_c^2
    std::array<std::array<WidePack, B>, count> lobe;         ///< sum w b_(B-1) b_i
    std::array<std::array<WidePack, 3>, count> lobe_target;  ///< sum w b_(B-1) target_c
};

template <class Text>
StartSums<Text> start_sums(std::span<const typename TexelBatch<Text::term_count>::Row> rows) {
    constexpr size_t B = StartSums<Text>::B, last = B - 1, group = size_t(Text::start_group);
    StartSums<Text> out{};
    const auto shape_at = [](size_t i) {
        typename Text::Shape s;
        for (int k = 0; k < Text::shape_count; ++k) s.x[k] = Pack(float(Text::starts[i][k]));
        return s;
    };
    detail::for_runs(rows, [&](auto run) {
        Pack plain[B][B], target[B][3], squares;
        const typename Text::Shape any = shape_at(0);
        for (const auto& row : run) {
            const auto b = Text::basis(any, detail::terms_of<Text>(row));
            for (size_t c = 0; c < 3; ++c) squares += row.weight * row.target[c] * row.target[c];
            for (size_t i = 0; i < last; ++i) {
                const Pack weighted = row.weight * b.x[i];
                for (size_t j = 0; j <= i; ++j) plain[i][j] += weighted * b.x[j];
                for (size_t c = 0; c < 3; ++c) target[i][c] += weighted * row.target[c];
            }
        }
        for (size_t i = 0; i < last; ++i) {
            for (size_t j = 0; j <= i; ++j) out.plain[i][j] += widen(plain[i][j]);
            for (size_t c = 0; c < 3; ++c) out.target[i][c] += widen(target[i][c]);
        }
        out.squares += widen(squares);
        for (size_t first = 0; first < size_t(Text::start_count); first += group) {
            // all values of a group but the last are one variable, so that what depends on them alone is computed once
            Pack lobe[group][B], with_target[group][3];
            typename Text::Shape shape = shape_at(first);
            Pack varied[group];
            for (size_t g = 0; g < group; ++g) varied[g] = shape_at(first + g).x[Text::shape_count - 1];
            for (const auto& row : run) {
                const auto t = detail::terms_of<Text>(row);
#pragma GCC unroll 8
                for (size_t g = 0; g < group; ++g) {
                    shape.x[Text::shape_count - 1] = varied[g];
                    const auto b = Text::basis(shape, t);
                    const Pack weighted = row.weight * b.x[last];
                    for (size_t i = 0; i < B; ++i) lobe[g][i] += weighted * b.x[i];
                    for (size_t c = 0; c < 3; ++c) with_target[g][c] += weighted * row.target[c];
                }
            }
            for (size_t g = 0; g < group; ++g) {
                for (size_t i = 0; i < B; ++i) out.lobe[first + g][i] += widen(lobe[g][i]);
                for (size_t c = 0; c < 3; ++c) out.lobe_target[first + g][c] += widen(with_target[g][c]);
            }
        }
    });
    return out;
}

}  // namespace radiafit
