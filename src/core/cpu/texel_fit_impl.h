#pragma once
#include <limits>

#include "base/clock.h"
#include "base/flush_subnormals.h"
#include "base/instructions.h"
#include "cpu/lobe_starts.h"
#include "cpu/texel_fit.h"
#include "model/coefficient_solver.h"

/// The definitions of TexelFit: for the file that instantiates it for the models that there are, and for tests of
/// others.
namespace radiafit {

namespace detail {
/// The leading block of B columns.
template <int B, int C>
SmallMatrix<WidePack, B> leading(const SmallMatrix<WidePack, C>& m) {
    SmallMatrix<WidePack, B> out;
    for (size_t i = 0; i < size_t(B); ++i)
        for (size_t j = 0; j <= i; ++j) out[i][j] = m[i][j];
    return out;
}
inline bool any(const WidePack::Mask& m) {
    for (int lane = 0; lane < Pack::size; ++lane)
        if (m[lane]) return true;
    return false;
}
/// Parameter i of the shape that a texel has which wasn't fitted.
template <class Text>
constexpr double first_start(size_t i) {
    if constexpr (CompleteText<Text>::several_lobes)
        return Text::lobe_starts()[0][i % size_t(Text::lobe_shape_count)];
    else
        return Text::starts[0][i];
}
/// Pivots below this part of their diagonal entry can't be distinguished from zero in sums of floats.
constexpr double noise = 1e-6;
}  // namespace detail

template <class Text>
void TexelFit<Text>::Point::take(const Mask& which, const Point& other) {
    const auto mix = [&](WidePack& mine, const WidePack& theirs) { mine = WidePack::select(which, theirs, mine); };
    for (size_t c = 0; c < 3; ++c)
        for (size_t k = 0; k < size_t(B); ++k) mix(a[c][k], other.a[c][k]);
    for (size_t i = 0; i < size_t(Q); ++i) mix(s[i], other.s[i]);
    for (size_t i = 0; i < size_t(C); ++i) {
        for (size_t j = 0; j <= i; ++j) mix(sums.shared[i][j], other.sums.shared[i][j]);
        for (size_t c = 0; c < 3; ++c) mix(sums.linear[i][c], other.sums.linear[i][c]);
    }
    mix(sums.error, other.sums.error);
}

/// The prior's part of the sums at p; the shape's part of their slopes and curvatures is along_shape()'s to add.
template <class Text>
void TexelFit<Text>::add_prior(const Prior& prior, Point& p) {
    for (size_t k = 0; k < size_t(B); ++k) {
        const WidePack weight(prior.weight[k]);
        p.sums.shared[k][k] += weight;
        for (size_t c = 0; c < 3; ++c) {
            const WidePack off = p.a[c][k] - WidePack(prior.mean[c][k]);
            p.sums.linear[k][c] += weight * off;
            p.sums.error += WidePack(0.5) * weight * off * off;
        }
    }
    for (size_t i = 0; i < size_t(Q); ++i) {
        const WidePack off = p.s[i] - WidePack(prior.shape_mean[i]);
        p.sums.error += WidePack(0.5 * prior.shape_weight[i]) * off * off;
    }
}

/// Its part of the sums that starts are chosen by.
template <class Text>
template <class T>
void TexelFit<Text>::add_prior(const Prior& prior, StartSums<T>& sums) {
    constexpr size_t plain = StartSums<T>::P;
    for (size_t k = 0; k < size_t(B); ++k) {
        const WidePack weight(prior.weight[k]);
        if (k < plain) {
            sums.plain[k][k] += weight;
            for (size_t c = 0; c < 3; ++c) sums.target[k][c] += weight * prior.mean[c][k];
        }
        for (size_t i = 0; k >= plain && i < size_t(Text::start_count); ++i) {
            sums.lobe[i][k - plain][k] += weight;
            for (size_t c = 0; c < 3; ++c) sums.lobe_target[i][k - plain][c] += weight * prior.mean[c][k];
        }
    }
}

/// Sums at p, then the coefficients' optimum for p's shape, and the sums there.
template <class Text>
void TexelFit<Text>::evaluate(const Batch& batch, Point& p, const Prior* prior) {
    typename Model::Parameters packed;
    for (size_t k = 0; k < size_t(B); ++k)
        for (size_t c = 0; c < 3; ++c) {
            packed[3 * k + c] = narrow(p.a[c][k]);
            p.a[c][k] = widen(packed[3 * k + c]);
        }
    for (size_t i = 0; i < size_t(Q); ++i) {
        packed[size_t(3 * B) + i] = narrow(p.s[i]);
        p.s[i] = widen(packed[size_t(3 * B) + i]);
    }
    p.sums = texel_sums<Text>(batch.rows(), packed);
    if (prior) add_prior(*prior, p);
    const SmallMatrix<WidePack, B> a = detail::leading<B, C>(p.sums.shared);
    // a plain linear fit has no bounds that would keep coefficients small where samples don't determine them
    const CoefficientSolver<Model, WidePack> solver(a, detail::noise,
                                                    Q > 0 ? SmallPivots::raised : SmallPivots::left_out);
    for (size_t c = 0; c < 3; ++c) {
        SmallVector<WidePack, B> g;
        for (size_t k = 0; k < size_t(B); ++k) g[k] = p.sums.linear[k][c];
        const auto best = solver.step(c, p.a[c], g);
        for (size_t k = 0; k < size_t(B); ++k) {
            p.a[c][k] += best.step[k];
            for (size_t i = 0; i < size_t(C); ++i)
                p.sums.linear[i][c] += p.sums.shared[std::max(i, k)][std::min(i, k)] * best.step[k];
        }
        p.sums.error += best.change;
    }
    p.sums.error = max(p.sums.error, WidePack(0.0));
}

/// E's Gauss-Newton model along the shape, with the coefficients at their optimum throughout: those within their bounds
/// follow, the others stay.
template <class Text>
template <class>
auto TexelFit<Text>::along_shape(const Point& p, const Prior* prior) -> Quadratic {
    Quadratic out{};
    const auto& shared = p.sums.shared;
    for (size_t c = 0; c < 3; ++c) {
        SmallMatrix<WidePack, B> a = detail::leading<B, C>(shared);
        Mask free[size_t(B)];
        for (size_t k = 0; k < size_t(B); ++k) {
            free[k] = (p.a[c][k] > WidePack(Model::channel_bounds(c)[k][0])) &
                      (p.a[c][k] < WidePack(Model::channel_bounds(c)[k][1]));
            for (size_t j = 0; j < k; ++j) a[k][j] = WidePack::select(free[k] & free[j], a[k][j], 0.0);
        }
        const SmallFactor<WidePack, B> factor(a, detail::noise);
        SmallVector<WidePack, B> follow[size_t(Model::slopes)];
        const auto lobe = [&](size_t i) -> const WidePack& { return p.a[c][size_t(Model::slope_basis(int(i)))]; };
        for (size_t i = 0; i < size_t(Model::slopes); ++i) {
            const size_t row = size_t(Model::slope_shape(int(i)));
            for (size_t k = 0; k < size_t(B); ++k)
                follow[i][k] = WidePack::select(free[k], shared[size_t(B) + i][k], 0.0);
            follow[i] = factor.forward(follow[i]);
            for (size_t j = 0; j <= i; ++j) {
                const size_t column = size_t(Model::slope_shape(int(j)));
                const WidePack product =
                    lobe(i) * lobe(j) * (shared[size_t(B) + i][size_t(B) + j] - factor.product(follow[i], follow[j]));
                out.curvature[std::max(row, column)][std::min(row, column)] += product;
                if (i != j && row == column) out.curvature[row][row] += product;  // (i, j), and (j, i)
            }
            out.gradient[row] += lobe(i) * p.sums.linear[size_t(B) + i][c];
        }
    }
    for (size_t i = 0; prior && i < size_t(Q); ++i) {
        const WidePack weight(prior->shape_weight[i]);
        out.curvature[i][i] += weight;
        out.gradient[i] += weight * (p.s[i] - WidePack(prior->shape_mean[i]));
    }
    return out;
}

/// The directions in which E has a slope or a curvature, the gauge's tangent made stiff: it has neither.
template <class Text>
template <class>
auto TexelFit<Text>::propose(const Point& p, const WidePack& damping, const Prior* prior) -> Step {
    const Quadratic model = along_shape(p, prior);
    SmallMatrix<WidePack, Q> full = with_gauge(p.s, model.curvature);
    SmallVector<WidePack, Q> down;
    for (size_t i = 0; i < size_t(Q); ++i) {
        // a parameter at its bound that would move beyond stays there
        const auto lowest = double(float(Text::shape_bounds[i][0])), highest = double(float(Text::shape_bounds[i][1]));
        const Mask held = ((p.s[i] <= WidePack(lowest)) & (model.gradient[i] > WidePack(0.0))) |
                          ((p.s[i] >= WidePack(highest)) & (model.gradient[i] < WidePack(0.0)));
        down[i] = WidePack::select(held, 0.0, -model.gradient[i]);
        for (size_t j = 0; j < i; ++j) full[i][j] = WidePack::select(held, 0.0, full[i][j]);
        for (size_t k = i + 1; k < size_t(Q); ++k) full[k][i] = WidePack::select(held, 0.0, full[k][i]);
    }
    SmallMatrix<WidePack, Q> damped = full;
    for (size_t i = 0; i < size_t(Q); ++i) damped[i][i] += damping * model.curvature[i][i];
    Step out{SmallFactor<WidePack, Q>(damped, detail::noise).solve(down), 0.0};
    for (size_t i = 0; i < size_t(Q); ++i) {
        out.promised += WidePack(0.5) * out.by[i] * (down[i] + damping * model.curvature[i][i] * out.by[i]);
    }
    return out;
}

/// `of` plus a curvature along the gauge's tangent, where it has none.
template <class Text>
template <class>
auto TexelFit<Text>::with_gauge(const SmallVector<WidePack, Q>& s, const SmallMatrix<WidePack, Q>& of)
    -> SmallMatrix<WidePack, Q> {
    SmallMatrix<WidePack, Q> m = of;
    if constexpr (Model::gauge_count > 0) {
        const typename Text::Shape tangent = Text::gauge_tangent(shape_of(s));
        WidePack trace(0.0);
        for (size_t i = 0; i < size_t(Q); ++i) trace += m[i][i];
        for (size_t i = 0; i < size_t(Q); ++i)
            for (size_t j = 0; j <= i; ++j) m[i][j] += trace * widen(tangent.x[i] * tangent.x[j]);
    }
    return m;
}

template <class Text>
template <class>
auto TexelFit<Text>::moved(const Point& from, const Step& step) -> Point {
    Point to{from.a, from.s, {}};
    for (size_t i = 0; i < size_t(Q); ++i)
        to.s[i] =
            min(max(from.s[i] + step.by[i], WidePack(Text::shape_bounds[i][0])), WidePack(Text::shape_bounds[i][1]));
    typename Text::Shape shape = shape_of(to.s);
    if constexpr (Model::gauge_count > 0) Text::fix_gauge(shape);  // the coefficients are solved for anyway
    for (size_t i = 0; i < size_t(Q); ++i) to.s[i] = widen(shape.x[i]);
    return to;
}

/// How well the samples alone distinguish the columns of the Jacobian: the least part of one that no others make up.
template <class Text>
WidePack TexelFit<Text>::least_pivot(const Point& p, const Prior* prior) {
    SmallMatrix<WidePack, C> m = p.sums.shared;
    for (size_t k = 0; prior && k < size_t(B); ++k) m[k][k] -= WidePack(prior->weight[k]);
    if constexpr (Model::shaped > 1 || Model::any_held()) {
        return least_pivot_of_all(p, m);
    } else if constexpr (Q > 0) {
        SmallMatrix<WidePack, Q> shape;
        for (size_t i = 0; i < size_t(Q); ++i)
            for (size_t j = 0; j <= i; ++j) shape[i][j] = m[size_t(B) + i][size_t(B) + j];
        shape = with_gauge(p.s, shape);
        for (size_t i = 0; i < size_t(Q); ++i)
            for (size_t j = 0; j <= i; ++j) m[size_t(B) + i][size_t(B) + j] = shape[i][j];
    }
    return SmallFactor<WidePack, C>(m, detail::noise).smallest();
}

/// Where the channels don't share the columns: of J'J over all parameters that aren't held. shared: of the samples.
template <class Text>
template <class>
WidePack TexelFit<Text>::least_pivot_of_all(const Point& p, const SmallMatrix<WidePack, C>& shared) {
    constexpr size_t N = size_t(Model::parameters), first = size_t(3 * B);
    SmallMatrix<WidePack, int(N)> m{};
    // a shape is told by what its basis functions look like, even where their coefficients are 0
    std::array<std::array<WidePack, 3>, size_t(B)> height;
    for (size_t k = 0; k < size_t(B); ++k) {
        WidePack squares(0.0);
        for (size_t c = 0; c < 3; ++c) squares += p.a[c][k] * p.a[c][k];
        for (size_t c = 0; c < 3; ++c)
            height[k][c] =
                WidePack::select(squares > WidePack(0.0), p.a[c][k], WidePack(Model::held(int(3 * k + c)) ? 0.0 : 1.0));
    }
    for (size_t c = 0; c < 3; ++c) {
        for (size_t k = 0; k < size_t(B); ++k)
            for (size_t j = 0; j <= k; ++j) m[3 * k + c][3 * j + c] = shared[k][j];
        for (size_t i = 0; i < size_t(Model::slopes); ++i) {
            const size_t of = size_t(Model::slope_basis(int(i))), row = first + size_t(Model::slope_shape(int(i)));
            for (size_t k = 0; k < size_t(B); ++k) m[row][3 * k + c] += height[of][c] * shared[size_t(B) + i][k];
            for (size_t j = 0; j < size_t(Model::slopes); ++j) {
                const size_t with = size_t(Model::slope_basis(int(j)));
                m[row][first + size_t(Model::slope_shape(int(j)))] +=
                    height[of][c] * height[with][c] * shared[size_t(B) + std::max(i, j)][size_t(B) + std::min(i, j)];
            }
        }
    }
    for (size_t i = 0; i < N; ++i) {
        if (!Model::held(int(i))) continue;
        for (size_t j = 0; j < i; ++j) m[i][j] = WidePack(0.0);
        for (size_t j = i + 1; j < N; ++j) m[j][i] = WidePack(0.0);
        m[i][i] = WidePack(1.0);
    }
    if constexpr (Model::gauge_count > 0) {
        SmallMatrix<WidePack, Q> shape;
        for (size_t i = 0; i < size_t(Q); ++i)
            for (size_t j = 0; j <= i; ++j) shape[i][j] = m[first + i][first + j];
        shape = with_gauge(p.s, shape);
        for (size_t i = 0; i < size_t(Q); ++i)
            for (size_t j = 0; j <= i; ++j) m[first + i][first + j] = shape[i][j];
    }
    return SmallFactor<WidePack, int(N)>(m, detail::noise).smallest();
}

template <class Text>
auto TexelFit<Text>::run(const Batch& batch, const Point& start, Trace* trace, const Prior* prior) const -> Outcomes {
    const FlushSubnormals flush;  // far from a sharp lobe's peak all products are
    Point now = start;
    evaluate(batch, now, prior);
    Outcomes out;
    Mask active{};
    for (int lane = 0; lane < Pack::size; ++lane) {
        Outcome& o = out[size_t(lane)];
        o.samples = batch.count(lane);
        if (!batch.finite(lane) || !std::isfinite(now.sums.error[lane]))
            o.status = Status::not_finite;
        else if (!o.samples)
            o.status = Status::no_samples;
        else
            active.set(lane, true);
    }
    const auto end = [&](const Mask& which, Status status) {
        for (int lane = 0; lane < Pack::size; ++lane)
            if (active[lane] && which[lane]) out[size_t(lane)].status = status, active.set(lane, false);
    };
    const Mask all = active;
    const Stopwatch clock;
    const auto note = [&](const Mask& accepted) {
        if (!trace) return;
        TraceRow row{int(trace->rows.size()), clock.wall_s()};
        for (int lane = 0; lane < Pack::size; ++lane) {
            if (all[lane]) row.error += now.sums.error[lane] / batch.count(lane);
            row.accepted += accepted[lane];
            row.active += active[lane];
        }
        trace->rows.push_back(row);
    };
    note(all);
    if constexpr (Q == 0) {
        // once more from the solution: residuals are small there, so that their sums are accurate
        evaluate(batch, now, prior);
        end(all, Status::stationary);
    } else {
        WidePack damping(1e-2), exact;  // `exact`: what rounding alone leaves of E
        for (int lane = 0; lane < Pack::size; ++lane) exact.set(lane, 1e-14 * batch.squares(lane));
        for (int k = 0; k < options_.iterations; ++k) {
            const Step step = propose(now, damping, prior);
            Mask tiny = all;
            for (size_t i = 0; i < size_t(Q); ++i) tiny = tiny & (max(step.by[i], -step.by[i]) <= WidePack(6e-8));
            end(tiny | (now.sums.error <= exact) |
                    (step.promised <= WidePack(options_.tolerance) * now.sums.error + exact),
                Status::stationary);
            if (!detail::any(active)) break;

            Point trial = moved(now, step);
            evaluate(batch, trial, prior);
            const Mask better = active & (trial.sums.error < now.sums.error);
            const WidePack gain = now.sums.error - trial.sums.error;
            const WidePack factor = WidePack::select(gain > WidePack(0.75) * step.promised, 0.3,
                                                     WidePack::select(gain < WidePack(0.25) * step.promised, 3.0, 1.0));
            damping = max(damping * WidePack::select(better, factor, 10.0), WidePack(1e-9));
            now.take(better, trial);
            const Mask done = better & (gain <= WidePack(options_.tolerance) * now.sums.error);
            for (int lane = 0; lane < Pack::size; ++lane) out[size_t(lane)].iterations += active[lane] ? 1 : 0;
            end(done | (damping > WidePack(1e7)), Status::stationary);
            note(better);
        }
        end(all, Status::max_iterations);
    }
    const Mask told_apart = least_pivot(now, prior) > WidePack(detail::noise);
    constexpr uint32_t columns = uint32_t(Model::independent());
    for (int lane = 0; lane < Pack::size; ++lane) {
        Outcome& o = out[size_t(lane)];
        const bool fitted = all[lane];
        if (fitted && (o.samples < columns || !told_apart[lane])) o.status = Status::underdetermined;
        o.error = fitted ? now.sums.error[lane] : 0;
        o.parameters = parameters_of(now, lane, fitted);
    }
    return out;
}

template <class Text>
auto TexelFit<Text>::parameters_of(const Point& p, int lane, bool fitted) -> Parameters {
    Parameters out{};
    for (size_t k = 0; k < size_t(B); ++k)
        for (size_t c = 0; c < 3; ++c) out[3 * k + c] = float(fitted ? p.a[c][k][lane] : Model::least(k, c));
    if constexpr (Q > 0)
        for (size_t i = 0; i < size_t(Q); ++i)
            out[size_t(3 * B) + i] = fitted ? float(p.s[i][lane]) : float(detail::first_start<Text>(i));
    return out;
}

template <class Text>
auto TexelFit<Text>::best_start(const Batch& batch, const Prior* prior) -> Point {
    Point best{};
    if constexpr (!Model::coefficients_may_be_zero())
        for (size_t c = 0; c < 3; ++c)
            for (size_t k = 0; k < size_t(B); ++k) best.a[c][k] = WidePack(Model::least(k, c));
    if constexpr (CompleteText<Text>::several_lobes) {
        const FlushSubnormals flush;
        const LobeStarts<Text> starts = greedy_starts<Text>(batch.rows(), prior);
        best.a = starts.a;
        best.s = starts.s;
    } else if constexpr (Q > 0) {
        const FlushSubnormals flush;
        StartSums<Text> sums = start_sums<Text>(batch.rows());
        if (prior) add_prior(*prior, sums);
        WidePack lowest(std::numeric_limits<double>::infinity());
        SmallMatrix<WidePack, B> a = sums.plain;
        std::array<std::array<WidePack, 3>, size_t(B)> target = sums.target;
        for (size_t i = 0; i < size_t(Text::start_count); ++i) {
            for (size_t l = 0; l < StartSums<Text>::K; ++l) {
                a[StartSums<Text>::P + l] = sums.lobe[i][l];
                target[StartSums<Text>::P + l] = sums.lobe_target[i][l];
            }
            const CoefficientSolver<Model, WidePack> solver(a, detail::noise, SmallPivots::raised);
            Point p{};
            WidePack error(0.0);
            for (size_t c = 0; c < 3; ++c) {
                SmallVector<WidePack, B> g;
                for (size_t k = 0; k < size_t(B); ++k) g[k] = -target[k][c];
                const auto fit = solver.from_zero(c, g);
                p.a[c] = fit.coefficients;
                error += fit.change;
            }
            for (size_t j = 0; j < size_t(Q); ++j) {
                p.s[j] = WidePack(Text::starts[i][j]);
                if (!prior) continue;
                const WidePack off = p.s[j] - prior->shape_mean[j];
                error += WidePack(0.5 * prior->shape_weight[j]) * off * off;
            }
            // among equals the first: rounding alone would take a lobe that no sample meets
            const Mask better = error < lowest * WidePack::select(lowest > WidePack(0.0), 1 - 1e-9, 1 + 1e-9);
            best.take(better, p);
            lowest = WidePack::select(better, error, lowest);
        }
    }
    return best;
}

template <class Text>
auto TexelFit<Text>::solve(const Batch& batch, Trace* trace, const Prior* prior) const -> Outcomes {
    Outcomes out;
    with_widest_vectors([&] { out = run(batch, best_start(batch, prior), trace, prior); });
    return out;
}

template <class Text>
auto TexelFit<Text>::solve(const Batch& batch, const std::array<Parameters, Pack::size>& start) const -> Outcomes {
    Point p{};
    for (int lane = 0; lane < Pack::size; ++lane) {
        const auto at = [&](size_t i) {
            const auto [lowest, highest] = Model::bounds(int(i));
            return std::clamp(double(start[size_t(lane)][i]), lowest, highest);
        };
        for (size_t k = 0; k < size_t(B); ++k)
            for (size_t c = 0; c < 3; ++c) p.a[c][k].set(lane, at(3 * k + c));
        for (size_t i = 0; i < size_t(Q); ++i) p.s[i].set(lane, at(size_t(3 * B) + i));
    }
    if constexpr (Q > 0) p = moved(p, Step{});
    Outcomes out;
    with_widest_vectors([&] { out = run(batch, p, nullptr, nullptr); });
    return out;
}

template <class Text>
auto TexelFit<Text>::start(const Batch& batch) -> std::array<Parameters, Pack::size> {
    std::array<Parameters, Pack::size> out;
    with_widest_vectors([&] {
        Point p = best_start(batch, nullptr);
        if constexpr (Q == 0) evaluate(batch, p, nullptr);
        for (int lane = 0; lane < Pack::size; ++lane) out[size_t(lane)] = parameters_of(p, lane, batch.count(lane) > 0);
    });
    return out;
}

}  // namespace radiafit
