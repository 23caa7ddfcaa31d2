#include "reference/varpro_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/wording.h"
#include "reference/projected_energy.h"

namespace radiafit::fits {
namespace {

using V = Lanes<double>;

/// A mask of lanes, as comparisons of vectors give it.
using Mask = decltype(V{} < V{});

double half_square_beyond(const LfmOptions& o, double x) {
    return ObjectiveText<double>::bound_error(x, double(o.lower), double(o.upper), double(o.mu), false);
}

/// Each channel's model of F around its accepted view map h,
///     m(d) = g'd + 1/2 d'Hd + mu E_b(h + d),   H and g without E_b of h,
/// and the damping of its minimization.
class Newton {
public:
    explicit Newton(const LfmVertex& vertex)
        : vertex_(vertex),
          size_(vertex.size() - vertex.view_begin()),
          h_(size_),
          gradient_(size_),
          diagonal_(size_),
          hessian_diagonal_(size_),
          product_(size_),
          curved_(size_),
          step_(vertex.view->texel_count(), size_, vertex.terms()) {}

    /// The lanes' models become the energy's last one, at view map h.
    void take(const ProjectedEnergy& energy, const V* h, Mask lanes) {
        LaneCholesky& hessian = step_.a();
        for (size_t i = 0; i < size_; ++i) {
            h_[i] = lanes ? h[i] : h_[i];
            gradient_[i] = lanes ? energy.gradient(i) : gradient_[i];
            diagonal_[i] = lanes ? energy.diagonal(i) : diagonal_[i];
            for (size_t j = 0; j < i; ++j) hessian.at(i, j) = lanes ? energy.hessian(i, j) : hessian.at(i, j);
            hessian_diagonal_[i] = lanes ? energy.hessian(i, i) : hessian_diagonal_[i];
        }
        multiply(h_, product_);
    }

    /// x <- the minimizer of m + damping/2 d'Dd as a view map, damping raised until that is convex. Returns the
    /// decrease m(0) - m(d).
    V step(V* x) {
        for (int attempt = 0; attempt < 30; ++attempt) {
            for (size_t i = 0; i < size_; ++i) {
                const V held = damping_ * diagonal_[i];
                step_.a().at(i, i) = hessian_diagonal_[i] + held;
                step_.b()[i] = product_[i] - gradient_[i] + held * h_[i];
                x[i] = h_[i];
            }
            const unsigned bad = step_.solve(vertex_.options, x);
            if (bad == 0) break;
            for (int c = 0; c < 3; ++c)
                if (bad >> c & 1) damping_[c] = std::max(10 * damping_[c], 1e-6);
        }
        V decrease{};
        std::vector<V>& d = step_.b();
        for (size_t i = 0; i < size_; ++i) d[i] = x[i] - h_[i];
        multiply(d, curved_);
        for (size_t i = 0; i < size_; ++i) decrease -= d[i] * (gradient_[i] + 0.5 * curved_[i]);
        for (size_t i = 0; i < size_ && vertex_.options.mu > 0; i += vertex_.terms())
            for (int c = 0; c < 3; ++c)
                decrease[c] +=
                    half_square_beyond(vertex_.options, h_[i][c]) - half_square_beyond(vertex_.options, x[i][c]);
        return decrease;
    }

    /// ratio: decrease of F over what was foreseen.
    void learn(int c, double ratio) {
        if (ratio > 0) {
            damping_[c] = std::max(least, damping_[c] * std::max(0.03, 1 - std::pow(2 * ratio - 1, 3)));
            growth_[c] = 4;
        } else {
            damping_[c] *= growth_[c];
            growth_[c] *= 2;
        }
    }

private:
    /// y = H x.
    void multiply(const std::vector<V>& x, std::vector<V>& y) {
        for (size_t i = 0; i < size_; ++i) step_.a().at(i, i) = hessian_diagonal_[i];
        step_.a().multiply(x.data(), y.data());
    }

    static constexpr double least = 1e-8;  ///< what 32 bits leave unsure in the Hessian
    const LfmVertex& vertex_;
    size_t size_;
    std::vector<V> h_, gradient_, diagonal_;
    std::vector<V> hessian_diagonal_;  ///< the rest of H is in step_.a()
    std::vector<V> product_, curved_;  ///< H h, H d
    HalfStep step_;
    V damping_ = V{1e-2, 1e-2, 1e-2, 1e-2}, growth_ = V{4, 4, 4, 4};
};

}  // namespace

VertexSolver varpro_solver(const LfmOptions& model, const VarproOptions& options) {
    require_modern_penalty(model, "varpro");
    const int unknowns = model.view_side * model.view_side * model.terms;
    if (unknowns > 1024)  // some tenths of a second a step, growing with the cube
        throw UserError(fmt::format(
            "solver 'varpro' factors a dense matrix of view-side^2 times terms = {} rows; choose a smaller {} "
            "(1024 rows at most) or another solver",
            unknowns, option_name("view-side")));
    const auto tiles = std::make_shared<TileSmoothness>(model);
    const auto view = std::make_shared<Smoothness>(MapNeighbours::square(model.view_side));
    return [=](const LfmVertex& vertex, std::span<V> p, VertexRun& run) {
        JointRows rows(vertex, options.stop_residual, run);
        ProjectedEnergy energy(vertex, *tiles, *view);
        Newton newton(vertex);
        std::vector<V> trial(p.begin(), p.end());
        V* const view_map = trial.data() + vertex.view_begin();
        V foreseen{};
        rows.begin(lfm_error(vertex, p.data()));
        rows.end_where_enough();
        for (int k = 0; k < options.iterations; ++k) {
            const bool solved = energy.evaluate(trial.data());
            Mask accepted{};
            for (int c = 0; c < 3; ++c) {
                if (!rows.active(c)) continue;
                const double before = rows.error(c), after = solved ? energy.error()[c] : INFINITY;
                if (k > 0) newton.learn(c, (before - after) / foreseen[c]);
                accepted[c] = after < before ? -1 : 0;
                rows.add(c, std::min(before, after));
                if (k > 0 && accepted[c] && before - after <= options.stop_change * before)
                    rows.end(c, Status::stationary);
            }
            for (size_t i = 0; i < p.size(); ++i) p[i] = accepted ? trial[i] : p[i];
            if (!rows.any_active()) break;
            newton.take(energy, view_map, accepted);
            foreseen = newton.step(view_map);
            for (int c = 0; c < 3; ++c)
                if (rows.active(c) && !(foreseen[c] > 1e-12 * rows.error(c))) rows.end(c, Status::stationary);
        }
        rows.finish();
    };
}

}  // namespace radiafit::fits
