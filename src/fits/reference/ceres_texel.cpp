#include "reference/ceres_texel.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <unordered_map>

#include "base/pack.h"
#include "model/small_solve.h"
#include "model/texel_texts.h"
#include "reference/ceres_status.h"

namespace radiafit::fits {
namespace {

template <class Text>
using Samples = std::span<const TexelSample<Text::term_count>>;

template <class Text>
typename Text::Terms terms_of(const TexelSample<Text::term_count>& sample) {
    typename Text::Terms t;
    std::copy(sample.term.begin(), sample.term.end(), t.x);
    return t;
}

/// sqrt(w) (m_c - target_c), [sample][channel]. jacobian, if not null: of row i by parameter k at
/// [i * row_step + k * column_step].
template <class Text>
void evaluate(Samples<Text> samples, const typename TexelLocal<Text>::Parameters& p, double* residuals,
              double* jacobian, size_t row_step, size_t column_step) {
    using Model = TexelLocal<Text>;
    constexpr size_t B = size_t(Model::basis), Q = size_t(Model::shape), N = size_t(Model::parameters);
    const auto shape = Model::shape_of(p);
    if (jacobian) std::fill_n(jacobian, 3 * samples.size() * N, 0.0);
    for (const auto& sample : samples) {
        const double root = std::sqrt(double(sample.weight));
        const typename Model::Terms t = terms_of<Text>(sample);
        if (!jacobian) {
            const auto value = Model::value(p, t);
            for (size_t c = 0; c < 3; ++c) *residuals++ = root * (value[c] - double(sample.target[c]));
            continue;
        }
        const auto q = Model::columns(shape, t);
        for (size_t c = 0; c < 3; ++c, jacobian += row_step) {
            double value = 0;
            for (size_t k = 0; k < B; ++k) {
                value += p[3 * k + c] * q[k];
                jacobian[(3 * k + c) * column_step] = root * q[k];
            }
            for (size_t i = 0; i < Q; ++i) jacobian[(3 * B + i) * column_step] = root * p[3 * (B - 1) + c] * q[B + i];
            *residuals++ = root * (value - double(sample.target[c]));
        }
    }
}

/// Of one texel after another that have so many samples.
template <class Text>
class WholeCost final : public ceres::CostFunction {
public:
    static constexpr int first = 0, count = TexelLocal<Text>::parameters;  ///< of the parameters that Ceres sees

    explicit WholeCost(size_t samples) {
        set_num_residuals(3 * int(samples));
        mutable_parameter_block_sizes()->push_back(count);
    }
    void take(Samples<Text> samples) { samples_ = samples; }
    void complete(typename TexelLocal<Text>::Parameters&) const {}
    bool Evaluate(const double* const* block, double* residuals, double** jacobians) const override {
        typename TexelLocal<Text>::Parameters p;
        std::copy_n(block[0], p.size(), p.begin());
        evaluate<Text>(samples_, p, residuals, jacobians ? jacobians[0] : nullptr, p.size(), 1);
        return true;
    }

private:
    Samples<Text> samples_;
};

/// What is left for the shape once the coefficients are the best for it, within bounds.
template <class Text>
class ProjectedCost final : public ceres::CostFunction {
public:
    using Model = TexelLocal<Text>;
    static constexpr size_t B = size_t(Model::basis), Q = size_t(Model::shape), C = B + Q;
    static constexpr int first = 3 * int(B), count = int(Q);
    using Coefficients = std::array<std::array<double, B>, 3>;  ///< [channel][basis]

    explicit ProjectedCost(size_t samples) : columns_(samples) {
        set_num_residuals(3 * int(samples));
        mutable_parameter_block_sizes()->push_back(int(Q));
    }
    void take(Samples<Text> samples) { samples_ = samples; }
    /// Sets the coefficients to the best for the shape.
    void complete(typename Model::Parameters& p) const {
        const Coefficients a = coefficients(p.data() + first);
        for (size_t k = 0; k < B; ++k)
            for (size_t c = 0; c < 3; ++c) p[3 * k + c] = a[c][k];
    }

    bool Evaluate(const double* const* block, double* residuals, double** jacobians) const override {
        const Coefficients a = coefficients(block[0]);
        for (size_t s = 0; s < samples_.size(); ++s)
            for (size_t c = 0; c < 3; ++c) {
                residuals[3 * s + c] = -target(s, c);
                for (size_t k = 0; k < B; ++k) residuals[3 * s + c] += a[c][k] * columns_[s][k];
            }
        if (jacobians && jacobians[0])
            for (size_t c = 0; c < 3; ++c) project(a[c], c, jacobians[0]);
        return true;
    }

    /// The best for this shape [Q]. Leaves the columns and their products.
    Coefficients coefficients(const double* x) const {
        typename Model::Parameters p{};
        std::copy_n(x, Q, p.begin() + 3 * B);
        const auto shape = Model::shape_of(p);
        products_ = {};
        std::array<SmallVector<double, int(B)>, 3> right{};
        for (size_t s = 0; s < samples_.size(); ++s) {
            const auto q = Model::columns(shape, terms_of<Text>(samples_[s]));
            for (size_t i = 0; i < C; ++i) columns_[s][i] = std::sqrt(double(samples_[s].weight)) * q[i];
            for (size_t i = 0; i < C; ++i)
                for (size_t j = 0; j <= std::min(i, B - 1); ++j) products_[i][j] += columns_[s][i] * columns_[s][j];
            for (size_t c = 0; c < 3; ++c)
                for (size_t k = 0; k < B; ++k) right[c][k] += columns_[s][k] * target(s, c);
        }
        SmallMatrix<double, int(B)> square{};
        double bounds[B][2];
        SmallVector<double, int(B)> start{};
        for (size_t i = 0; i < B; ++i) {
            std::copy_n(products_[i].begin(), i + 1, square[i].begin());
            bounds[i][0] = Model::bounds(int(3 * i))[0], bounds[i][1] = Model::bounds(int(3 * i))[1];
            start[i] = std::clamp(0.0, bounds[i][0], bounds[i][1]);
        }
        const SmallFactor<double, int(B)> factor(square, 1e-12, SmallPivots::left_out);
        Coefficients a;
        for (size_t c = 0; c < 3; ++c) {
            SmallVector<double, int(B)> slope;
            for (size_t i = 0; i < B; ++i) {
                slope[i] = -right[c][i];
                for (size_t k = 0; k < B; ++k) slope[i] += square[std::max(i, k)][std::min(i, k)] * start[k];
            }
            const auto best = bounded_step<double, int(B)>(square, factor, slope, start, bounds);
            for (size_t i = 0; i < B; ++i) a[c][i] = start[i] + best.step[i];
        }
        return a;
    }

private:
    double target(size_t s, size_t c) const {
        return std::sqrt(double(samples_[s].weight)) * double(samples_[s].target[c]);
    }
    /// Kaufman's Jacobian of one channel: derivatives by the shape less what the free coefficients make up for.
    void project(const std::array<double, B>& a, size_t c, double* jacobian) const {
        SmallMatrix<double, int(B)> free{};
        std::array<bool, B> is_free;
        for (size_t i = 0; i < B; ++i) {
            const auto [low, high] = Model::bounds(int(3 * i));
            is_free[i] = a[i] > low && a[i] < high;
            for (size_t j = 0; j < i; ++j) free[i][j] = is_free[i] && is_free[j] ? products_[i][j] : 0;
            free[i][i] = is_free[i] ? products_[i][i] : 1;
        }
        const SmallFactor<double, int(B)> factor(free, 1e-12, SmallPivots::left_out);
        for (size_t i = 0; i < Q; ++i) {
            SmallVector<double, int(B)> right;
            for (size_t k = 0; k < B; ++k) right[k] = is_free[k] ? products_[B + i][k] : 0;
            const auto made_up = factor.solve(right);
            for (size_t s = 0; s < samples_.size(); ++s) {
                double left = columns_[s][B + i];
                for (size_t k = 0; k < B; ++k) left -= made_up[k] * columns_[s][k];
                jacobian[(3 * s + c) * Q + i] = a[B - 1] * left;
            }
        }
    }

    Samples<Text> samples_;
    mutable std::vector<std::array<double, C>> columns_;  ///< sqrt(w) times the columns of J, at the last shape
    mutable std::array<std::array<double, B>, C> products_ =
        {};  ///< column by basis function; of those, the lower triangle
};

/// As ceres::TinySolver asks for it. Beyond a bound the model is that at the bound.
template <class Text>
class TinyFunction {
public:
    using Scalar = double;
    using Model = TexelLocal<Text>;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Model::parameters };

    void take(Samples<Text> samples) { samples_ = samples; }
    int NumResiduals() const { return 3 * int(samples_.size()); }
    bool operator()(const double* x, double* residuals, double* jacobian) const {
        typename Model::Parameters p;
        for (int i = 0; i < Model::parameters; ++i)
            p[size_t(i)] = std::clamp(x[i], Model::bounds(i)[0], Model::bounds(i)[1]);
        const size_t rows = size_t(NumResiduals());
        evaluate<Text>(samples_, p, residuals, jacobian, 1, rows);
        for (size_t i = 0; jacobian && i < p.size(); ++i)
            if (p[i] != x[i]) std::fill_n(jacobian + i * rows, rows, 0.0);
        return true;
    }

private:
    Samples<Text> samples_;
};

/// The same in 32-bit floats, eight samples side by side; the last eight are filled up with samples of weight 0.
template <class Text>
class TinyPackFunction {
public:
    using Scalar = float;
    using Lanes = typename Text::template with<Pack>;
    using Model = TexelLocal<Lanes>;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Model::parameters };

    void take(Samples<Text> samples) {
        eights_.clear();
        for (size_t first = 0; first < samples.size(); first += Pack::size) {
            Eight& eight = eights_.emplace_back();
            for (size_t lane = 0; lane < size_t(Pack::size); ++lane) {
                const bool there = first + lane < samples.size();
                const auto& sample = samples[there ? first + lane : first];
                for (size_t k = 0; k < size_t(Text::term_count); ++k) eight.terms.x[k].set(int(lane), sample.term[k]);
                for (size_t c = 0; c < 3; ++c) eight.target[c].set(int(lane), sample.target[c]);
                eight.root.set(int(lane), there ? std::sqrt(sample.weight) : 0.0f);
            }
        }
    }
    int NumResiduals() const { return 3 * Pack::size * int(eights_.size()); }
    bool operator()(const float* x, float* residuals, float* jacobian) const {
        constexpr size_t B = size_t(Model::basis), Q = size_t(Model::shape), N = size_t(Model::parameters);
        const size_t rows = size_t(NumResiduals());
        typename Model::Parameters p;
        for (size_t i = 0; i < N; ++i)
            p[i] = Pack(std::clamp(x[i], float(Model::bounds(int(i))[0]), float(Model::bounds(int(i))[1])));
        if (jacobian) std::fill_n(jacobian, N * rows, 0.0f);
        const auto shape = Model::shape_of(p);
        for (const Eight& eight : eights_) {
            std::array<Pack, B + Q> q;
            if (jacobian) {
                q = Model::columns(shape, eight.terms);
            } else {
                const auto basis = Lanes::basis(shape, eight.terms);
                std::copy_n(basis.x, B, q.begin());
            }
            for (size_t c = 0; c < 3; ++c, residuals += Pack::size) {
                Pack value(0.0f);
                for (size_t k = 0; k < B; ++k) value += p[3 * k + c] * q[k];
                store(residuals, eight.root * (value - eight.target[c]));
                if (!jacobian) continue;
                for (size_t k = 0; k < B; ++k) store(jacobian + (3 * k + c) * rows, eight.root * q[k]);
                const Pack lobe = eight.root * p[3 * (B - 1) + c];
                for (size_t i = 0; i < Q; ++i) store(jacobian + (3 * B + i) * rows, lobe * q[B + i]);
                jacobian += Pack::size;
            }
        }
        for (size_t i = 0; jacobian && i < N; ++i)
            if (p[i][0] != x[i]) std::fill_n(jacobian - rows + i * rows, rows, 0.0f);
        return true;
    }

private:
    struct Eight {
        typename Model::Terms terms;
        Pack target[3];
        Pack root;  ///< of the weight
    };
    static void store(float* to, const Pack& x) { std::memcpy(to, &x.v, sizeof x.v); }

    std::vector<Eight> eights_;
};

/// What is left of one texel's solver for the next one that has as many samples.
template <class Text, class Cost>
class CeresProblem {
public:
    explicit CeresProblem(size_t samples) : cost_(samples), problem_(options()) {
        double* x = parameters_.data() + Cost::first;
        problem_.AddResidualBlock(&cost_, nullptr, x);
        for (int i = 0; i < Cost::count; ++i) {
            problem_.SetParameterLowerBound(x, i, TexelLocal<Text>::bounds(Cost::first + i)[0]);
            problem_.SetParameterUpperBound(x, i, TexelLocal<Text>::bounds(Cost::first + i)[1]);
        }
    }
    CeresTexelOutcome<Text> solve(Samples<Text> samples, const typename TexelLocal<Text>::Parameters& start,
                                  const ceres::Solver::Options& options) {
        parameters_ = start;
        cost_.take(samples);
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem_, &summary);
        cost_.complete(parameters_);
        return {parameters_, summary.final_cost, int(summary.iterations.size()) - 1,
                ceres_status(summary.termination_type, Status::not_finite)};
    }

private:
    static ceres::Problem::Options options() {
        ceres::Problem::Options o;
        o.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        return o;
    }
    typename TexelLocal<Text>::Parameters parameters_{};
    Cost cost_;
    ceres::Problem problem_;
};

template <class Text, class Cost>
class ByCeres final : public CeresTexels<Text> {
public:
    explicit ByCeres(const CeresTexelOptions& options) {
        silence_ceres();
        options_.linear_solver_type =
            options.linear == CeresTexelOptions::Linear::dense_qr ? ceres::DENSE_QR : ceres::DENSE_NORMAL_CHOLESKY;
        options_.initial_trust_region_radius = options.initial_radius;
        options_.max_num_iterations = options.iterations;
        options_.function_tolerance = options.tolerance;
        options_.gradient_tolerance = 1e-14;
        options_.parameter_tolerance = 1e-12;
        options_.num_threads = 1;
        options_.logging_type = ceres::SILENT;
    }

private:
    CeresTexelOutcome<Text> solve_some(Samples<Text> samples,
                                       const typename TexelLocal<Text>::Parameters& start) override {
        auto& problem = problems_[samples.size()];
        if (!problem) problem = std::make_unique<CeresProblem<Text, Cost>>(samples.size());
        return problem->solve(samples, start, options_);
    }

    ceres::Solver::Options options_;
    std::unordered_map<size_t, std::unique_ptr<CeresProblem<Text, Cost>>> problems_;  ///< by their number of samples
};

template <class Text, class Function>
class ByTinySolver final : public CeresTexels<Text> {
public:
    explicit ByTinySolver(const CeresTexelOptions& options) : options_(options) {}

private:
    using Scalar = typename Function::Scalar;
    CeresTexelOutcome<Text> solve_some(Samples<Text> samples,
                                       const typename TexelLocal<Text>::Parameters& start) override {
        function_.take(samples);
        typename ceres::TinySolver<Function>::Parameters x;
        for (size_t i = 0; i < start.size(); ++i) x[Eigen::Index(i)] = Scalar(start[i]);
        residuals_.resize(size_t(function_.NumResiduals()));
        function_(x.data(), residuals_.data(), nullptr);
        Scalar cost = 0;
        for (const Scalar r : residuals_) cost += r * r / 2;
        solver_.options.max_num_iterations = options_.iterations;
        solver_.options.function_tolerance = Scalar(options_.tolerance) * cost;  // TinySolver's is absolute
        solver_.options.cost_threshold = 0;
        solver_.options.gradient_tolerance = Scalar(1e-14);
        solver_.options.parameter_tolerance = Scalar(1e-12);
        solver_.options.initial_trust_region_radius = Scalar(options_.initial_radius);
        const auto& summary = solver_.Solve(function_, &x);
        if (!std::isfinite(summary.final_cost)) return {start, double(cost), summary.iterations, Status::not_finite};
        typename TexelLocal<Text>::Parameters p;
        for (size_t i = 0; i < p.size(); ++i)
            p[i] = std::clamp(double(x[Eigen::Index(i)]), TexelLocal<Text>::bounds(int(i))[0],
                              TexelLocal<Text>::bounds(int(i))[1]);
        return {p, double(summary.final_cost), summary.iterations,
                summary.iterations < options_.iterations ? Status::stationary : Status::max_iterations};
    }

    CeresTexelOptions options_;
    Function function_;
    ceres::TinySolver<Function> solver_;
    std::vector<Scalar> residuals_;
};

}  // namespace

template <class Text>
CeresTexelOutcome<Text> CeresTexels<Text>::solve(Samples samples, const Parameters& start) {
    if (samples.empty()) return {start};
    CeresTexelOutcome<Text> out = solve_some(samples, start);
    out.parameters = TexelLocal<Text>::canonical(out.parameters);
    return out;
}

template <class Text>
std::unique_ptr<CeresTexels<Text>> ceres_texels(const CeresTexelOptions& options) {
    using Method = CeresTexelOptions::Method;
    if (options.method == Method::tiny) return std::make_unique<ByTinySolver<Text, TinyFunction<Text>>>(options);
    if (options.method == Method::tiny_pack)
        return std::make_unique<ByTinySolver<Text, TinyPackFunction<Text>>>(options);
    if constexpr (TexelLocal<Text>::shape > 0)  // else the whole is linear
        if (options.method == Method::projected) return std::make_unique<ByCeres<Text, ProjectedCost<Text>>>(options);
    return std::make_unique<ByCeres<Text, WholeCost<Text>>>(options);
}

#define EACH(NAME)                                        \
    template class CeresTexels<texel_text::NAME<double>>; \
    template std::unique_ptr<CeresTexels<texel_text::NAME<double>>> ceres_texels(const CeresTexelOptions&);
RADIAFIT_TEXEL_MODELS(EACH)
#undef EACH

namespace {

template <class Text>
class OfShaded final : public CeresTexelSolver {
public:
    explicit OfShaded(const CeresTexelOptions& options) : texels_(ceres_texels<Text>(options)) {}
    CeresTexelFit solve(std::span<const ShadedSample> samples, std::span<const float> start) override {
        using Model = TexelLocal<Text>;
        samples_.resize(samples.size());
        for (size_t i = 0; i < samples.size(); ++i) {
            const ShadedSample& s = samples[i];
            const auto terms = Text::sample_terms({double(s.u.x()), double(s.u.y()), double(s.u.z())},
                                                  {double(s.v.x()), double(s.v.y()), double(s.v.z())});
            for (int k = 0; k < Text::term_count; ++k) samples_[i].term[size_t(k)] = float(terms.x[k]);
            std::copy_n(s.target, 3, samples_[i].target.begin());
            samples_[i].weight = s.weight;
        }
        typename Model::Parameters p;
        for (int i = 0; i < Model::parameters; ++i)
            p[size_t(i)] = std::clamp(double(start[size_t(i)]), Model::bounds(i)[0], Model::bounds(i)[1]);
        const auto out = texels_->solve(samples_, p);
        return {{out.parameters.begin(), out.parameters.end()}, out.error, out.iterations, out.status};
    }

private:
    std::unique_ptr<CeresTexels<Text>> texels_;
    std::vector<TexelSample<Text::term_count>> samples_;
};

}  // namespace

std::unique_ptr<CeresTexelSolver> ceres_texel_solver(const TexelModel& model, const CeresTexelOptions& options) {
#define EACH(NAME) \
    if (model.name == std::string_view(#NAME)) return std::make_unique<OfShaded<texel_text::NAME<double>>>(options);
    RADIAFIT_TEXEL_MODELS(EACH)
#undef EACH
    throw std::invalid_argument("ceres_texel_solver: an unknown model");
}

}  // namespace radiafit::fits
