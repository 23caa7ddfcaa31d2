#pragma once
#include "cpu/texel_batch.h"
#include "model/loss.h"
#include "model/small_solve.h"

/// The loops over samples of texel-local models, a lane per texel.
namespace radiafit {

/// With residuals r_c = m_c - target_c and columns q (TexelLocal::columns), per lane:
///     shared [i][j] = sum w q_i q_j           lower triangle: 15 of Lafortune
///     linear [i][c] = sum w q_i r_c           15; coefficients' gradient, and per channel what makes the shape's
///     error         = 1/2 sum w r_c^2         1
/// The gradient by a number of the shape is the sum over its slopes j of sum_c a[slope_basis(j)][c] linear[B + j][c].
/// Keeping its three parts apart (9 + 1 sums would do for plain Levenberg-Marquardt) lets the coefficients, which are
/// linear, be solved exactly after every sweep. Floats over 48 samples at a time, doubles beyond.
template <class Text>
struct TexelSums {
    static constexpr int C = TexelLocal<Text>::shared;
    SmallMatrix<WidePack, C> shared;
    std::array<std::array<WidePack, 3>, size_t(C)> linear;
    WidePack error{};
};

namespace detail {
/// Rows whose sums are taken in floats, between two visits to doubles; what is computed of them stays in L1.
constexpr size_t run_length = 48;
template <class Row, class Body>
void for_runs(std::span<const Row> rows, const Body& body) {
    for (size_t i = 0; i < rows.size(); i += run_length) body(rows.subspan(i, std::min(run_length, rows.size() - i)));
}
template <class Text>
typename Text::Terms terms_of(const typename TexelBatch<Text::term_count>::Row& row) {
    typename Text::Terms t;
    for (int k = 0; k < Text::term_count; ++k) t.x[k] = row.term[k];
    return t;
}
}  // namespace detail

/// `Text`: a model's text with real = Pack. p: TexelLocal's parameters, a lane per texel. By a robust loss the weights
/// w are the samples' times what the loss leaves them, and the error is the loss.
template <class Text, class Loss = SquareLoss>
TexelSums<Text> texel_sums(std::span<const typename TexelBatch<Text::term_count>::Row> rows,
                           const typename TexelLocal<Text>::Parameters& p, Loss loss = {}) {
    using Model = TexelLocal<Text>;
    constexpr size_t B = size_t(Model::basis), C = size_t(Model::shared);
    const typename Text::Shape shape = Model::shape_of(p);
    TexelSums<Text> out{};
    // Three loops, because all sums at once are more than there are registers.
    struct Computed {
        Pack q[C];
        Pack weighted[3];  ///< w r_c
        Pack weight;
    };
    std::array<Computed, detail::run_length> computed;
    detail::for_runs(rows, [&](auto run) {
        Pack error{};
        for (size_t n = 0; n < run.size(); ++n) {
            const auto& row = run[n];
            const auto q = Model::columns(shape, detail::terms_of<Text>(row));
            for (size_t i = 0; i < C; ++i)
                computed[n].q[i] = q[i];  // one by one: a copy of all reads what was just written
            computed[n].weight = row.weight;
            Pack residual[3];
            for (size_t c = 0; c < 3; ++c) {
                Pack r = p[c] * q[0] - row.target[c];
                for (size_t k = 1; k < B; ++k) r += p[3 * k + c] * q[k];
                computed[n].weighted[c] = row.weight * r;
                if constexpr (!Loss::reweighs) error += computed[n].weighted[c] * r;
                residual[c] = r;
            }
            if constexpr (Loss::reweighs) {
                const Pack squared = computed[n].weighted[0] * residual[0] + computed[n].weighted[1] * residual[1] +
                                     computed[n].weighted[2] * residual[2];
                error += loss.value(squared);
                const Pack weight = loss.weight(squared);
                computed[n].weight = row.weight * weight;
                for (Pack& pull : computed[n].weighted) pull *= weight;
            }
        }
        out.error += WidePack(0.5) * widen(error);

        Pack linear[C][3] = {};
        for (size_t n = 0; n < run.size(); ++n)
            for (size_t i = 0; i < C; ++i)
                for (size_t c = 0; c < 3; ++c) linear[i][c] += computed[n].q[i] * computed[n].weighted[c];
        for (size_t i = 0; i < C; ++i)
            for (size_t c = 0; c < 3; ++c) out.linear[i][c] += widen(linear[i][c]);

        Pack shared[C * (C + 1) / 2] = {};
        for (size_t n = 0; n < run.size(); ++n)
            for (size_t i = 0, at = 0; i < C; ++i) {
                const Pack weighted = computed[n].weight * computed[n].q[i];
                for (size_t j = 0; j <= i; ++j) shared[at++] += weighted * computed[n].q[j];
            }
        for (size_t i = 0, at = 0; i < C; ++i)
            for (size_t j = 0; j <= i; ++j) out.shared[i][j] += widen(shared[at++]);
    });
    return out;
}

/// Its error alone.
template <class Text, class Loss = SquareLoss>
WidePack texel_error(std::span<const typename TexelBatch<Text::term_count>::Row> rows,
                     const typename TexelLocal<Text>::Parameters& p, Loss loss = {}) {
    WidePack error(0.0);
    detail::for_runs(rows, [&](auto run) {
        Pack sum{};
        for (const auto& row : run) {
            auto r = TexelLocal<Text>::value(p, detail::terms_of<Text>(row));
            for (size_t c = 0; c < 3; ++c) r[c] -= row.target[c];
            if constexpr (Loss::reweighs)
                sum += loss.value(row.weight * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]));
            else
                for (size_t c = 0; c < 3; ++c) sum += row.weight * r[c] * r[c];
        }
        error += WidePack(0.5) * widen(sum);
    });
    return error;
}

/// How many of `Text::starts` are taken together: every group of so many differs in its last value only, so that what
/// depends on the others is computed once. From 1 to 8.
template <class Text>
consteval size_t start_group() {
    constexpr size_t count = size_t(Text::start_count), last = size_t(Text::shape_count) - 1;
    const auto alike = [](size_t i, size_t j) {
        for (size_t k = 0; k < last; ++k)
            if (Text::starts[i][k] != Text::starts[j][k]) return false;
        return true;
    };
    const auto divides = [&](size_t group) {
        if (count % group != 0) return false;
        for (size_t i = 0; i < count; ++i)
            if (!alike(i, i - i % group)) return false;
        return true;
    };
    size_t group = 8;
    while (!divides(group)) --group;
    return group;
}

/// What a linear fit of the coefficients needs at each of `Text::starts`: those basis functions that don't depend on
/// the shape are summed once.
template <class Text>
struct StartSums {
    static constexpr size_t B = size_t(Text::basis_count), count = size_t(Text::start_count);
    static constexpr size_t K = size_t(TexelLocal<Text>::shaped), P = B - K;
    SmallMatrix<WidePack, Text::basis_count> plain;                         ///< sum w b_i b_j, i, j < P
    std::array<std::array<WidePack, 3>, B> target;                          ///< sum w b_i target_c, i < P
    std::array<std::array<std::array<WidePack, B>, K>, count> lobe;         ///< sum w b_(P+l) b_i, i <= P + l
    std::array<std::array<std::array<WidePack, 3>, K>, count> lobe_target;  ///< sum w b_(P+l) target_c
};

template <class Text>
StartSums<Text> start_sums(std::span<const typename TexelBatch<Text::term_count>::Row> rows) {
    constexpr size_t B = StartSums<Text>::B, K = StartSums<Text>::K, P = StartSums<Text>::P,
                     group = start_group<Text>();
    StartSums<Text> out{};
    const auto shape_at = [](size_t i) {
        typename Text::Shape s;
        for (int k = 0; k < Text::shape_count; ++k) s.x[k] = Pack(float(Text::starts[i][k]));
        return s;
    };
    std::array<std::array<Pack, P + 3>, detail::run_length> weighted;  // w b_i, w target_c
    Pack lobes[detail::run_length][K][group];
    detail::for_runs(rows, [&](auto run) {
        Pack plain[B][B] = {}, target[B][3] = {};
        const typename Text::Shape any = shape_at(0);
        for (size_t n = 0; n < run.size(); ++n) {
            const auto& row = run[n];
            const auto b = Text::basis(any, detail::terms_of<Text>(row));
            for (size_t c = 0; c < 3; ++c) weighted[n][P + c] = row.weight * row.target[c];
            for (size_t i = 0; i < P; ++i) {
                weighted[n][i] = row.weight * b.x[i];
                for (size_t j = 0; j <= i; ++j) plain[i][j] += weighted[n][i] * b.x[j];
                for (size_t c = 0; c < 3; ++c) target[i][c] += weighted[n][i] * row.target[c];
            }
        }
        for (size_t i = 0; i < P; ++i) {
            for (size_t j = 0; j <= i; ++j) out.plain[i][j] += widen(plain[i][j]);
            for (size_t c = 0; c < 3; ++c) out.target[i][c] += widen(target[i][c]);
        }
        for (size_t first = 0; first < size_t(Text::start_count); first += group) {
            // one variable for all values of a group but the last
            typename Text::Shape shape = shape_at(first);
            Pack varied[group];
            for (size_t g = 0; g < group; ++g) varied[g] = shape_at(first + g).x[Text::shape_count - 1];
            for (size_t n = 0; n < run.size(); ++n) {
                const auto t = detail::terms_of<Text>(run[n]);
                if constexpr (K == 1 && requires { Text::last_basis_at_starts(shape, t, lobes[n][0]); }) {
                    Text::last_basis_at_starts(shape, t, lobes[n][0]);
                } else {
#pragma GCC unroll 8
                    for (size_t g = 0; g < group; ++g) {
                        shape.x[Text::shape_count - 1] = varied[g];
                        const auto b = Text::basis(shape, t);
                        for (size_t l = 0; l < K; ++l) lobes[n][l][g] = b.x[P + l];
                    }
                }
            }
            for (size_t l = 0; l < K; ++l) {
                Pack lobe[group][B] = {}, with_target[group][3] = {};
                for (size_t n = 0; n < run.size(); ++n)
#pragma GCC unroll 8
                    for (size_t g = 0; g < group; ++g) {
                        const Pack b = lobes[n][l][g];
                        for (size_t i = 0; i < P; ++i) lobe[g][i] += weighted[n][i] * b;
                        for (size_t j = 0; j <= l; ++j) lobe[g][P + j] += run[n].weight * b * lobes[n][j][g];
                        for (size_t c = 0; c < 3; ++c) with_target[g][c] += weighted[n][P + c] * b;
                    }
                for (size_t g = 0; g < group; ++g) {
                    for (size_t i = 0; i <= P + l; ++i) out.lobe[first + g][l][i] += widen(lobe[g][i]);
                    for (size_t c = 0; c < 3; ++c) out.lobe_target[first + g][l][c] += widen(with_target[g][c]);
                }
            }
        }
    });
    return out;
}

}  // namespace radiafit
