#include "reference/ceres_texel.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

template <class Text>
class WholeCost final : public ceres::CostFunction {
public:
    explicit WholeCost(Samples<Text> samples) : samples_(samples) {
        set_num_residuals(3 * int(samples.size()));
        mutable_parameter_block_sizes()->push_back(TexelLocal<Text>::parameters);
    }
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
    using Coefficients = std::array<std::array<double, B>, 3>;  ///< [channel][basis]

    explicit ProjectedCost(Samples<Text> samples) : samples_(samples), columns_(samples.size()) {
        set_num_residuals(3 * int(samples.size()));
        if (Q > 0) mutable_parameter_block_sizes()->push_back(int(Q));
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
struct TinyFunction {
    using Scalar = double;
    using Model = TexelLocal<Text>;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Model::parameters };

    static typename Model::Parameters within(const double* x) {
        typename Model::Parameters p;
        for (int i = 0; i < Model::parameters; ++i)
            p[size_t(i)] = std::clamp(x[i], Model::bounds(i)[0], Model::bounds(i)[1]);
        return p;
    }
    int NumResiduals() const { return 3 * int(samples.size()); }
    bool operator()(const double* x, double* residuals, double* jacobian) const {
        const typename Model::Parameters p = within(x);
        const size_t rows = size_t(NumResiduals());
        evaluate<Text>(samples, p, residuals, jacobian, 1, rows);
        for (size_t i = 0; jacobian && i < p.size(); ++i)
            if (p[i] != x[i]) std::fill_n(jacobian + i * rows, rows, 0.0);
        return true;
    }

    Samples<Text> samples;
};

template <class Text>
CeresTexelOutcome<Text> solve_tiny(Samples<Text> samples, const typename TexelLocal<Text>::Parameters& start,
                                   const CeresTexelOptions& options) {
    using Function = TinyFunction<Text>;
    const Function function{samples};
    ceres::TinySolver<Function> solver;
    std::vector<double> residuals(3 * samples.size());
    function(start.data(), residuals.data(), nullptr);
    double cost = 0;
    for (const double r : residuals) cost += 0.5 * r * r;
    solver.options.max_num_iterations = options.iterations;
    solver.options.function_tolerance = options.tolerance * cost;  // TinySolver's is absolute
    solver.options.cost_threshold = 0;
    solver.options.gradient_tolerance = 1e-14;
    solver.options.parameter_tolerance = 1e-12;
    solver.options.initial_trust_region_radius = options.initial_radius;
    typename ceres::TinySolver<Function>::Parameters x;
    std::copy(start.begin(), start.end(), x.data());
    const auto& summary = solver.Solve(function, &x);
    const bool finite = std::isfinite(summary.final_cost);
    const bool stopped = summary.iterations < options.iterations;
    return {finite ? Function::within(x.data()) : start, finite ? summary.final_cost : cost, summary.iterations,
            !finite   ? Status::not_finite
            : stopped ? Status::stationary
                      : Status::max_iterations};
}

}  // namespace

template <class Text>
CeresTexelOutcome<Text> ceres_texel(std::span<const TexelSample<Text::term_count>> samples,
                                    const typename TexelLocal<Text>::Parameters& start,
                                    const CeresTexelOptions& options) {
    using Model = TexelLocal<Text>;
    using Method = CeresTexelOptions::Method;
    CeresTexelOutcome<Text> out{start};
    if (samples.empty()) return out;
    silence_ceres();
    if (options.method == Method::tiny) {
        out = solve_tiny<Text>(samples, start, options);
        out.parameters = Model::canonical(out.parameters);
        return out;
    }
    const bool projected = options.method == Method::projected && Model::shape > 0;  // else the whole is linear
    const ProjectedCost<Text> shape_cost(samples);
    const WholeCost<Text> whole_cost(samples);
    double* x = out.parameters.data() + (projected ? 3 * Model::basis : 0);
    const int first = projected ? 3 * Model::basis : 0;
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(problem_options);
    const ceres::CostFunction& cost = projected ? static_cast<const ceres::CostFunction&>(shape_cost) : whole_cost;
    problem.AddResidualBlock(const_cast<ceres::CostFunction*>(&cost), nullptr, x);
    for (int i = first; i < Model::parameters; ++i) {
        problem.SetParameterLowerBound(x, i - first, Model::bounds(i)[0]);
        problem.SetParameterUpperBound(x, i - first, Model::bounds(i)[1]);
    }
    ceres::Solver::Options o;
    o.linear_solver_type =
        options.linear == CeresTexelOptions::Linear::dense_qr ? ceres::DENSE_QR : ceres::DENSE_NORMAL_CHOLESKY;
    o.initial_trust_region_radius = options.initial_radius;
    o.max_num_iterations = options.iterations;
    o.function_tolerance = options.tolerance;
    o.gradient_tolerance = 1e-14;
    o.parameter_tolerance = 1e-12;
    o.num_threads = 1;
    o.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(o, &problem, &summary);
    if (projected) {
        const auto a = shape_cost.coefficients(x);
        for (size_t k = 0; k < size_t(Model::basis); ++k)
            for (size_t c = 0; c < 3; ++c) out.parameters[3 * k + c] = a[c][k];
    }
    out.parameters = Model::canonical(out.parameters);
    out.error = summary.final_cost;
    out.iterations = int(summary.iterations.size()) - 1;
    out.status = ceres_status(summary.termination_type, Status::not_finite);
    return out;
}

#define EACH(NAME)                                                                              \
    template CeresTexelOutcome<texel_text::NAME<double>> ceres_texel<texel_text::NAME<double>>( \
        std::span<const TexelSample<texel_text::NAME<double>::term_count>>,                     \
        const TexelLocal<texel_text::NAME<double>>::Parameters&, const CeresTexelOptions&);
RADIAFIT_TEXEL_MODELS(EACH)
#undef EACH

namespace {

template <class Text>
CeresTexelFit fit(std::span<const ShadedSample> samples, std::span<const float> start,
                  const CeresTexelOptions& options) {
    using Model = TexelLocal<Text>;
    std::vector<TexelSample<Text::term_count>> texel(samples.size());
    for (size_t i = 0; i < samples.size(); ++i) {
        const ShadedSample& s = samples[i];
        const auto terms = Text::sample_terms({double(s.u.x()), double(s.u.y()), double(s.u.z())},
                                              {double(s.v.x()), double(s.v.y()), double(s.v.z())});
        for (int k = 0; k < Text::term_count; ++k) texel[i].term[size_t(k)] = float(terms.x[k]);
        std::copy_n(s.target, 3, texel[i].target.begin());
        texel[i].weight = s.weight;
    }
    typename Model::Parameters p;
    for (int i = 0; i < Model::parameters; ++i)
        p[size_t(i)] = std::clamp(double(start[size_t(i)]), Model::bounds(i)[0], Model::bounds(i)[1]);
    const auto out = ceres_texel<Text>(texel, p, options);
    return {{out.parameters.begin(), out.parameters.end()}, out.error, out.iterations, out.status};
}

}  // namespace

CeresTexelFit ceres_texel(const TexelModel& model, std::span<const ShadedSample> samples, std::span<const float> start,
                          const CeresTexelOptions& options) {
#define EACH(NAME) \
    if (model.name == std::string_view(#NAME)) return fit<texel_text::NAME<double>>(samples, start, options);
    RADIAFIT_TEXEL_MODELS(EACH)
#undef EACH
    throw std::invalid_argument("ceres_texel: an unknown model");
}

}  // namespace radiafit::fits
