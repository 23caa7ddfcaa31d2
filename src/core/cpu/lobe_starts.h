#pragma once
#include <limits>

#include "cpu/texel_fit.h"

/// Where fits of several lobes begin.
namespace radiafit {

/// What a text of several lobes says of where one may begin: lobe_starts() are shapes of one lobe; from the first of a
/// group of `lobe_group` on, one_lobe_at_starts() gives the values of all in the group.
template <class Text>
struct LobeStarts {
    std::array<SmallVector<WidePack, Text::basis_count>, 3> a{};  ///< [channel][basis]
    SmallVector<WidePack, Text::shape_count> s{};
};

/// Lobe after lobe the start that lowers the squared residuals most, the coefficients of all before it following
/// (orthogonal matching pursuit, Pati et al. 1993). The prior's weights of coefficients count, and its means.
template <class Text>
LobeStarts<Text> greedy_starts(std::span<const typename TexelBatch<Text::term_count>::Row> rows,
                               const TexelPrior<Text>* prior);

namespace detail {

/// The basis functions chosen so far, and a texel's samples against them.
template <class Text>
class LobePursuit {
public:
    static constexpr size_t B = size_t(Text::basis_count), per_lobe = size_t(Text::lobe_shape_count),
                            group = size_t(Text::lobe_group);
    using Rows = std::span<const typename TexelBatch<Text::term_count>::Row>;

    LobePursuit(Rows rows, const TexelPrior<Text>* prior) : rows_(rows) {
        if (prior) prior_ = *prior;
        for (size_t l = 0; l < B; ++l)
            for (size_t i = 0; l > 0 && i < per_lobe; ++i)
                out_.s[(l - 1) * per_lobe + i] = WidePack(Text::lobe_starts()[0][i]);
    }

    LobeStarts<Text> run() {
        fit_coefficients(1);
        [this]<size_t... lobe>(std::index_sequence<lobe...>) {
            ((choose<lobe + 1>(), fit_coefficients(lobe + 2)), ...);
        }
        (std::make_index_sequence<B - 1>());
        return out_;
    }

private:
    using Coefficients = SmallMatrix<WidePack, Text::basis_count>;

    /// Samples whose sums are taken in floats, and whose residuals are kept while candidates are tried.
    static constexpr size_t kept = 96;
    template <class Body>
    void for_kept(const Body& body) const {
        for (size_t i = 0; i < rows_.size(); i += kept) body(rows_.subspan(i, std::min(kept, rows_.size() - i)));
    }

    typename Text::Shape shape() const {
        typename Text::Shape s;
        for (size_t i = 0; i < size_t(Text::shape_count); ++i) s.x[i] = narrow(out_.s[i]);
        return s;
    }

    /// The coefficients of the first `count` basis functions for the shapes chosen.
    void fit_coefficients(size_t count) {
        Coefficients a{};
        std::array<SmallVector<WidePack, Text::basis_count>, 3> g{};
        const typename Text::Shape s = shape();
        for_kept([&](auto run) {
            Pack shared[B][B] = {}, target[B][3] = {};
            for (const auto& row : run) {
                const auto b = Text::basis(s, terms_of<Text>(row));
                for (size_t i = 0; i < count; ++i) {
                    const Pack weighted = row.weight * b.x[i];
                    for (size_t j = 0; j <= i; ++j) shared[i][j] += weighted * b.x[j];
                    for (size_t c = 0; c < 3; ++c) target[i][c] += weighted * row.target[c];
                }
            }
            for (size_t i = 0; i < count; ++i) {
                for (size_t j = 0; j <= i; ++j) a[i][j] += widen(shared[i][j]);
                for (size_t c = 0; c < 3; ++c) g[c][i] += widen(target[i][c]);
            }
        });
        for (size_t i = 0; i < B; ++i) {
            const WidePack weight(prior_.weight[i]);
            a[i][i] += weight;
            if (i >= count) a[i][i] = WidePack(1.0);
            for (size_t c = 0; c < 3; ++c)
                g[c][i] = i < count ? g[c][i] + weight * WidePack(prior_.mean[c][i]) : WidePack(0.0);
        }
        factor_ = SmallFactor<WidePack, Text::basis_count>(a, 1e-6);
        for (size_t c = 0; c < 3; ++c) out_.a[c] = factor_.solve(g[c]);
    }

    /// The shape of lobe `at` from among the starts. A candidate b lowers the error by sum_c (b . r_c)^2 / 2 over what
    /// of b . b no chosen function makes up.
    template <size_t at>  // so that the sums over samples stay in registers
    void choose() {
        WidePack best(-1.0);
        std::array<WidePack, per_lobe> chosen;
        chosen.fill(WidePack(0.0));
        std::array<std::array<Pack, B + 3>, kept> against;  // weight times: chosen functions, residuals
        for (size_t first = 0; first < Text::lobe_starts().size(); first += group) {
            WidePack with[group][B] = {}, itself[group] = {}, pull[group][3] = {};
            for_kept([&](auto run) {
                if (first == 0 || rows_.size() > kept) weigh(run, at, against);
                Pack sum_with[group][B] = {}, sum_itself[group] = {}, sum_pull[group][3] = {};
                for (size_t n = 0; n < run.size(); ++n) {
                    Pack b[group];
                    Text::one_lobe_at_starts(first, terms_of<Text>(run[n]), b);
#pragma GCC unroll 8
                    for (size_t g = 0; g < group; ++g) {
                        for (size_t i = 0; i < at; ++i) sum_with[g][i] += against[n][i] * b[g];
                        for (size_t c = 0; c < 3; ++c) sum_pull[g][c] += against[n][B + c] * b[g];
                        sum_itself[g] += run[n].weight * b[g] * b[g];
                    }
                }
                for (size_t g = 0; g < group; ++g) {
                    for (size_t i = 0; i < at; ++i) with[g][i] += widen(sum_with[g][i]);
                    for (size_t c = 0; c < 3; ++c) pull[g][c] += widen(sum_pull[g][c]);
                    itself[g] += widen(sum_itself[g]);
                }
            });
            for (size_t g = 0; g < group; ++g) {
                SmallVector<WidePack, Text::basis_count> row;
                for (size_t i = 0; i < B; ++i) row[i] = with[g][i];
                row = factor_.forward(row);
                const WidePack alone = itself[g] + WidePack(prior_.weight[at]);
                const WidePack left = max(alone - factor_.product(row, row), WidePack(1e-3) * alone + WidePack(1e-12));
                const WidePack gain =
                    (pull[g][0] * pull[g][0] + pull[g][1] * pull[g][1] + pull[g][2] * pull[g][2]) / left;
                const auto better = gain > best;
                best = WidePack::select(better, gain, best);
                for (size_t i = 0; i < per_lobe; ++i)
                    chosen[i] = WidePack::select(better, Text::lobe_starts()[first + g][i], chosen[i]);
            }
        }
        for (size_t i = 0; i < per_lobe; ++i) out_.s[(at - 1) * per_lobe + i] = chosen[i];
    }

    template <class Run, class Against>
    void weigh(const Run& run, size_t count, Against& against) const {
        const typename Text::Shape s = shape();
        SmallVector<Pack, Text::basis_count> a[3];
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < B; ++i) a[c][i] = narrow(out_.a[c][i]);
        for (size_t n = 0; n < run.size(); ++n) {
            const auto b = Text::basis(s, terms_of<Text>(run[n]));
            for (size_t i = 0; i < count; ++i) against[n][i] = run[n].weight * b.x[i];
            for (size_t c = 0; c < 3; ++c) {
                Pack r = run[n].target[c];
                for (size_t i = 0; i < count; ++i) r -= a[c][i] * b.x[i];
                against[n][B + c] = run[n].weight * r;
            }
        }
    }

    Rows rows_;
    TexelPrior<Text> prior_{};
    LobeStarts<Text> out_;
    SmallFactor<WidePack, Text::basis_count> factor_{Coefficients{}, 1e-6};
};

}  // namespace detail

template <class Text>
LobeStarts<Text> greedy_starts(std::span<const typename TexelBatch<Text::term_count>::Row> rows,
                               const TexelPrior<Text>* prior) {
    return detail::LobePursuit<Text>(rows, prior).run();
}

}  // namespace radiafit
