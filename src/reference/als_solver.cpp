#include "reference/als_solver.h"

#include <cmath>
#include <memory>

#include "base/error.h"
#include "model/lfm_text.h"
#include "reference/lane_cholesky.h"

namespace radiafit {
namespace {

using V = Lanes<double>;
using Text = LfmText<double, V>;

/// L'L of one kind of map, lower triangle.
struct Smoothness {
    struct Entry {
        uint32_t row, column;
        double value;
    };
    std::vector<Entry> entries;
    size_t band = 0;  ///< texels

    explicit Smoothness(const MapNeighbours& map) {
        const size_t n = map.texel_count();
        std::vector<double> dense(n * n, 0.0);
        for (size_t r = 0; r < n; ++r) {  // one row of L: the number kept at the centre, -1 at each neighbour
            std::vector<std::pair<size_t, double>> row = {{r, double(map.of(r).size())}};
            for (uint16_t j : map.of(r)) row.emplace_back(j, -1.0);
            for (const auto& [i, a] : row)
                for (const auto& [j, b] : row) dense[i * n + j] += a * b;
        }
        for (uint32_t i = 0; i < n; ++i)
            for (uint32_t j = 0; j <= i; ++j)
                if (dense[i * n + j] != 0) {
                    entries.push_back({i, j, dense[i * n + j]});
                    band = std::max(band, size_t(i - j));
                }
    }
};

/// Minimizes 1/2 x'Ax - b'x + mu E_b(x) over one map's x (first terms bounded); x holds the present values.
class HalfStep {
public:
    HalfStep(size_t texels, size_t band, size_t terms) : terms_(terms), a_(texels * terms, band), factor_(a_) {
        b_.resize(texels * terms);
        active_.resize(texels);
        next_.resize(texels);
    }
    void clear() {
        a_.clear();
        std::fill(b_.begin(), b_.end(), V{});
    }
    LaneCholesky& a() { return a_; }
    std::vector<V>& b() { return b_; }

    void add_smoothness(const Smoothness& s, V lambda) {
        for (const auto& e : s.entries)
            for (size_t k = 0; k < terms_; ++k) a_.at(e.row * terms_ + k, e.column * terms_ + k) += lambda * e.value;
    }

    /// False where the system can't be solved; x is unchanged then.
    bool solve(const LfmOptions& o, V* x) {
        V largest{};
        for (size_t i = 0; i < a_.size(); ++i) largest = a_.at(i, i) > largest ? a_.at(i, i) : largest;
        // Far below what moves E_t in double, and enough to hold a parameter that nothing else does.
        const V ridge = largest > 0 ? 1e-12 * largest : V{1, 1, 1, 1};
        for (size_t i = 0; i < a_.size(); ++i) {
            a_.at(i, i) += ridge;
            b_[i] += ridge * x[i];
        }
        beyond_bounds(o, x, active_);
        for (int guess = 0; guess < 8; ++guess) {
            factor_ = a_;
            solution_ = b_;
            for (size_t t = 0; t < active_.size(); ++t)
                for (int c = 0; c < 3; ++c)
                    if (active_[t][c] != 0) {
                        factor_.at(t * terms_, t * terms_)[c] += double(o.mu);
                        solution_[t * terms_][c] += double(o.mu) * double(active_[t][c] < 0 ? o.lower : o.upper);
                    }
            if (!factor_.factor()) return false;
            factor_.solve(solution_.data());
            beyond_bounds(o, solution_.data(), next_);
            const bool same = std::equal(active_.begin(), active_.end(), next_.begin(), [](const V& p, const V& q) {
                return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
            });
            if (same) break;
            std::swap(active_, next_);
        }
        std::copy(solution_.begin(), solution_.end(), x);
        return true;
    }

private:
    /// -1 below the lower bound, 1 above the upper, else 0.
    void beyond_bounds(const LfmOptions& o, const V* x, std::vector<V>& out) const {
        const V lower = broadcast3(double(o.lower)), upper = broadcast3(double(o.upper));
        for (size_t t = 0; t < out.size(); ++t) {
            const V value = x[t * terms_];
            const V none{}, one = broadcast3(1.0);
            out[t] = o.mu > 0 ? (value < lower ? -one : value > upper ? one : none) : none;
        }
    }

    size_t terms_;
    LaneCholesky a_, factor_;
    std::vector<V> b_, solution_, active_, next_;
};

/// Working memory of one vertex, and its two half steps.
class Alternation {
public:
    Alternation(const LfmVertex& vertex, const Smoothness& tile, const Smoothness& view)
        : vertex_(vertex),
          tile_(tile),
          view_(view),
          terms_(vertex.terms()),
          map_step_(vertex.tile->texel_count(), tile.band * terms_ + terms_ - 1, terms_),
          view_step_(vertex.view->texel_count(), vertex.view->texel_count() * terms_, terms_),
          h_(terms_),
          products_(terms_ * (terms_ + 1) / 2),
          sums_(terms_) {}

    bool surface(V* p) {
        const size_t texels = vertex_.tile->texel_count();
        size_t group = 0;
        for (size_t map = 0; map < vertex_.maps; ++map) {
            map_step_.clear();
            LaneCholesky& a = map_step_.a();
            for (; vertex_.groups[group].map == map && group + 1 < vertex_.groups.size(); ++group) {
                const LfmVertex::Group& g = vertex_.groups[group];
                look_up(g, p);
                for (uint32_t s = g.first; s < vertex_.groups[group + 1].first; ++s) {
                    const size_t at = vertex_.local[s] * terms_;
                    for (size_t k = 0, n = 0; k < terms_; ++k) {
                        for (size_t l = 0; l <= k; ++l, ++n) a.at(at + k, at + l) += products_[n];
                        map_step_.b()[at + k] += h_[k] * vertex_.target[s];
                    }
                }
            }
            const V weight = broadcast3(vertex_.inverse_density);
            for (size_t t = 0; t < texels; ++t)
                for (size_t k = 0; k < terms_; ++k) {
                    for (size_t l = 0; l <= k; ++l) a.at(t * terms_ + k, t * terms_ + l) *= weight;
                    map_step_.b()[t * terms_ + k] *= weight;
                }
            map_step_.add_smoothness(tile_, broadcast3(vertex_.lambda_surface));
            if (!map_step_.solve(vertex_.options, p + map * texels * terms_)) return false;
        }
        return true;
    }

    bool view(V* p) {
        const size_t texels = vertex_.tile->texel_count();
        view_step_.clear();
        LaneCholesky& a = view_step_.a();
        for (size_t i = 0; i + 1 < vertex_.groups.size(); ++i) {
            const LfmVertex::Group& g = vertex_.groups[i];
            std::fill(products_.begin(), products_.end(), V{});
            std::fill(sums_.begin(), sums_.end(), V{});
            for (uint32_t s = g.first; s < vertex_.groups[i + 1].first; ++s) {
                const V* surface = p + (g.map * texels + vertex_.local[s]) * terms_;
                for (size_t k = 0, n = 0; k < terms_; ++k) {
                    for (size_t l = 0; l <= k; ++l, ++n) products_[n] += surface[k] * surface[l];
                    sums_[k] += surface[k] * vertex_.target[s];
                }
            }
            for (int x = 0; x < 4; ++x) {
                const size_t row = vertex_.corner(g, x) * terms_;
                for (size_t k = 0; k < terms_; ++k) {
                    view_step_.b()[row + k] += g.weight[x] * vertex_.inverse_density * sums_[k];
                    for (int y = 0; y <= x; ++y) {
                        const size_t column = vertex_.corner(g, y) * terms_;
                        const double weight = g.weight[x] * g.weight[y] * vertex_.inverse_density;
                        for (size_t l = 0; l < (y < x ? terms_ : k + 1); ++l)
                            a.at(row + k, column + l) += weight * products_[index(k, l)];
                    }
                }
            }
        }
        view_step_.add_smoothness(view_, vertex_.lambda_view);
        return view_step_.solve(vertex_.options, p + vertex_.view_begin());
    }

private:
    static size_t index(size_t k, size_t l) { return k >= l ? k * (k + 1) / 2 + l : l * (l + 1) / 2 + k; }
    /// h of every term and their products.
    void look_up(const LfmVertex::Group& g, const V* p) {
        const V* view = p + vertex_.view_begin();
        for (size_t k = 0, n = 0; k < terms_; ++k) {
            h_[k] = V{};
            for (int j = 0; j < 4; ++j) h_[k] += g.weight[j] * view[vertex_.corner(g, j) * terms_ + k];
            for (size_t l = 0; l <= k; ++l, ++n) products_[n] = h_[k] * h_[l];
        }
    }

    const LfmVertex& vertex_;
    const Smoothness &tile_, &view_;
    size_t terms_;
    HalfStep map_step_, view_step_;
    std::vector<V> h_, products_, sums_;
};

}  // namespace

VertexSolver als_solver(const LfmOptions& model, const AlsOptions& options) {
    if (model.mode == Mode::paper && model.mu > 0)
        throw UserError("solver 'als' needs the modern bounds penalty; choose --mode modern, or --mu 0");
    const auto tile = std::make_shared<Smoothness>(MapNeighbours::triangle(model.surface_side));
    const auto view = std::make_shared<Smoothness>(MapNeighbours::square(model.view_side));
    return [=](const LfmVertex& vertex, std::span<V> p, VertexRun& run) {
        const double start = run.clock();
        Alternation alternation(vertex, *tile, *view);
        std::vector<V> trial(p.begin(), p.end());
        V error = lfm_error(vertex, p.data());
        const double enough = 0.5 * double(vertex.surface_texels()) * options.stop_residual * options.stop_residual;
        run.joint = true;
        for (int c = 0; c < 3; ++c) {
            run.channel[c].status = std::isfinite(error[c]) ? Status::active : Status::not_finite;
            run.channel[c].error = {error[c]};
            run.channel[c].time_s = {run.clock() - start};
        }
        for (int k = 0; k < options.iterations; ++k) {
            bool any = false;
            for (const auto& c : run.channel) any = any || c.status == Status::active;
            if (!any) break;
            const bool solved = alternation.surface(trial.data()) && alternation.view(trial.data());
            const V after = lfm_error(vertex, trial.data());
            for (int c = 0; c < 3; ++c) {
                VertexRun::Channel& channel = run.channel[c];
                if (channel.status != Status::active) continue;
                // An exact half step can't raise E_t but by rounding.
                const bool lower = solved && after[c] < error[c];
                if (!lower || error[c] - after[c] <= options.stop_change * error[c])
                    channel.status = Status::stationary;
                if (lower) {
                    error[c] = after[c];
                    for (size_t i = 0; i < p.size(); ++i) p[i][c] = trial[i][c];
                }
                if (error[c] <= enough) channel.status = Status::residual;
                channel.error.push_back(error[c]);
                channel.time_s.push_back(run.clock() - start);
            }
            std::copy(p.begin(), p.end(), trial.begin());
        }
        for (auto& c : run.channel)
            if (c.status == Status::active) c.status = Status::max_iterations;
    };
}

}  // namespace radiafit
