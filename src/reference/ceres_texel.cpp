#include "reference/ceres_texel.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/texel_texts.h"
#include "reference/ceres_status.h"

namespace radiafit {
namespace {

/// sqrt(w) (m_c - target_c), [sample][channel].
template <class Text>
class TexelCost final : public ceres::CostFunction {
public:
    using Model = TexelLocal<Text>;
    using Samples = std::span<const TexelSample<Text::term_count>>;

    explicit TexelCost(Samples samples) : samples_(samples) {
        set_num_residuals(3 * int(samples.size()));
        mutable_parameter_block_sizes()->push_back(Model::parameters);
    }

    bool Evaluate(const double* const* block, double* residuals, double** jacobians) const override {
        constexpr size_t B = size_t(Model::basis), Q = size_t(Model::shape), N = size_t(Model::parameters);
        typename Model::Parameters p;
        std::copy_n(block[0], N, p.begin());
        const auto shape = Model::shape_of(p);
        double* rows = jacobians ? jacobians[0] : nullptr;
        if (rows) std::fill_n(rows, size_t(num_residuals()) * N, 0.0);
        for (const auto& sample : samples_) {
            const double root = std::sqrt(double(sample.weight));
            typename Model::Terms t;
            std::copy(sample.term.begin(), sample.term.end(), t.x);
            if (!rows) {
                const auto value = Model::value(p, t);
                for (size_t c = 0; c < 3; ++c) *residuals++ = root * (value[c] - double(sample.target[c]));
                continue;
            }
            const auto q = Model::columns(shape, t);
            for (size_t c = 0; c < 3; ++c, rows += N) {
                double value = 0;
                for (size_t k = 0; k < B; ++k) {
                    value += p[3 * k + c] * q[k];
                    rows[3 * k + c] = root * q[k];
                }
                for (size_t i = 0; i < Q; ++i) rows[3 * B + i] = root * p[3 * (B - 1) + c] * q[B + i];
                *residuals++ = root * (value - double(sample.target[c]));
            }
        }
        return true;
    }

private:
    Samples samples_;
};

}  // namespace

template <class Text>
CeresTexelOutcome<Text> ceres_texel(std::span<const TexelSample<Text::term_count>> samples,
                                    const typename TexelLocal<Text>::Parameters& start,
                                    const CeresTexelOptions& options) {
    using Model = TexelLocal<Text>;
    CeresTexelOutcome<Text> out{start};
    if (samples.empty()) return out;
    silence_ceres();
    double* x = out.parameters.data();
    TexelCost<Text> cost(samples);
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(problem_options);
    problem.AddResidualBlock(&cost, nullptr, x);
    for (int i = 0; i < Model::parameters; ++i) {
        problem.SetParameterLowerBound(x, i, Model::bounds(i)[0]);
        problem.SetParameterUpperBound(x, i, Model::bounds(i)[1]);
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

}  // namespace radiafit
