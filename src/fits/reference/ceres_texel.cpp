#include "reference/ceres_texel.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unordered_map>

#include "base/error.h"
#include "model/coefficient_solver.h"
#include "model/texel_texts.h"
#include "reference/ceres_status.h"
#include "reference/texel_residuals.h"
#include "reference/tiny_texel.h"

namespace radiafit::fits {
namespace {

/// Of one texel after another that have so many samples.
template <class Text>
class WholeCost final : public ceres::CostFunction {
public:
    static constexpr int first = 0, count = TexelLocal<Text>::parameters;  ///< of the parameters that Ceres sees

    explicit WholeCost(size_t samples) {
        set_num_residuals(3 * int(samples));
        mutable_parameter_block_sizes()->push_back(count);
    }
    void take(TexelSamples<Text> samples) { samples_ = samples; }
    void complete(typename TexelLocal<Text>::Parameters&) const {}
    bool Evaluate(const double* const* block, double* residuals, double** jacobians) const override {
        typename TexelLocal<Text>::Parameters p;
        std::copy_n(block[0], p.size(), p.begin());
        texel_residuals<Text>(samples_, p, residuals, jacobians ? jacobians[0] : nullptr, p.size(), 1);
        return true;
    }

private:
    TexelSamples<Text> samples_;
};

/// What is left for the shape once the coefficients are the best for it, within bounds.
template <class Text>
class ProjectedCost final : public ceres::CostFunction {
public:
    using Model = TexelLocal<Text>;
    static constexpr size_t B = size_t(Model::basis), Q = size_t(Model::shape), C = size_t(Model::shared);
    static constexpr int first = 3 * int(B), count = int(Q);
    using Coefficients = std::array<std::array<double, B>, 3>;  ///< [channel][basis]

    explicit ProjectedCost(size_t samples) : columns_(samples) {
        set_num_residuals(3 * int(samples));
        mutable_parameter_block_sizes()->push_back(int(Q));
    }
    void take(TexelSamples<Text> samples) { samples_ = samples; }
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
        for (size_t i = 0; i < B; ++i) std::copy_n(products_[i].begin(), i + 1, square[i].begin());
        const CoefficientSolver<Model, double> solver(square, 1e-12, SmallPivots::left_out);
        Coefficients a;
        for (size_t c = 0; c < 3; ++c) {
            SmallVector<double, int(B)> start, slope;
            for (size_t i = 0; i < B; ++i) start[i] = Model::least(i, c);
            for (size_t i = 0; i < B; ++i) {
                slope[i] = -right[c][i];
                for (size_t k = 0; k < B; ++k) slope[i] += square[std::max(i, k)][std::min(i, k)] * start[k];
            }
            const auto best = solver.step(c, start, slope);
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
            const auto [low, high] = Model::bounds(int(3 * i + c));
            is_free[i] = a[i] > low && a[i] < high;
            for (size_t j = 0; j < i; ++j) free[i][j] = is_free[i] && is_free[j] ? products_[i][j] : 0;
            free[i][i] = is_free[i] ? products_[i][i] : 1;
        }
        const SmallFactor<double, int(B)> factor(free, 1e-12, SmallPivots::left_out);
        for (size_t i = 0; i < size_t(Model::slopes); ++i) {
            SmallVector<double, int(B)> right;
            for (size_t k = 0; k < B; ++k) right[k] = is_free[k] ? products_[B + i][k] : 0;
            const auto made_up = factor.solve(right);
            for (size_t s = 0; s < samples_.size(); ++s) {
                double left = columns_[s][B + i];
                for (size_t k = 0; k < B; ++k) left -= made_up[k] * columns_[s][k];
                double& entry = jacobian[(3 * s + c) * Q + i % Q];
                left *= a[size_t(Model::slope_basis(int(i)))];
                entry = i < Q ? left : entry + left;
            }
        }
    }

    TexelSamples<Text> samples_;
    mutable std::vector<std::array<double, C>> columns_;  ///< sqrt(w) times the columns of J, at the last shape
    mutable std::array<std::array<double, B>, C> products_ =
        {};  ///< column by basis function; of those, the lower triangle
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
    CeresTexelOutcome<Text> solve(TexelSamples<Text> samples, const typename TexelLocal<Text>::Parameters& start,
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
    CeresTexelOutcome<Text> solve_some(TexelSamples<Text> samples,
                                       const typename TexelLocal<Text>::Parameters& start) override {
        auto& problem = problems_[samples.size()];
        if (!problem) problem = std::make_unique<CeresProblem<Text, Cost>>(samples.size());
        return problem->solve(samples, start, options_);
    }

    ceres::Solver::Options options_;
    std::unordered_map<size_t, std::unique_ptr<CeresProblem<Text, Cost>>> problems_;  ///< by their number of samples
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
std::unique_ptr<CeresTexels<Text>> ceres_texels([[maybe_unused]] const CeresTexelOptions& options) {
    using Method = CeresTexelOptions::Method;
    if constexpr (TexelLocal<Text>::parameters > most_ceres_parameters) {
        throw std::invalid_argument("ceres_texels: too many parameters");
    } else {
        if (options.method == Method::tiny || options.method == Method::tiny_pack) return tiny_texels<Text>(options);
        if constexpr (TexelLocal<Text>::shape > 0)  // else the whole is linear
            if (options.method == Method::projected)
                return std::make_unique<ByCeres<Text, ProjectedCost<Text>>>(options);
        return std::make_unique<ByCeres<Text, WholeCost<Text>>>(options);
    }
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
    throw UserError(
        fmt::format("model {}: Ceres is compiled for the program's own models alone; choose solver stream or two-step",
                    model.name));
}

}  // namespace radiafit::fits
