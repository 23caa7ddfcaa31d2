#include "cpu/texel_covariance.h"

#include <cmath>

#include "base/parallel.h"
#include "model/influence.h"

namespace radiafit {
namespace {

/// Row c of the Jacobian from the columns that the channels share; each channel's [parameters]. 0 at what is held.
void rows_of(const TexelModel& model, std::span<const float> p, std::span<const double> columns,
             std::array<Eigen::VectorXd, 3>& rows) {
    const size_t basis = size_t(model.basis), shaped = size_t(model.shaped);
    for (size_t c = 0; c < 3; ++c) {
        Eigen::VectorXd& row = rows[c];
        row.setZero(model.parameters);
        for (size_t k = 0; k < basis; ++k) row[Eigen::Index(3 * k + c)] = columns[k];
        for (size_t i = 0; i < size_t(model.shape); ++i)
            for (size_t l = 0; l < shaped; ++l)
                row[Eigen::Index(3 * basis + i)] +=
                    double(p[3 * (basis - shaped + l) + c]) * columns[basis + l * size_t(model.shape) + i];
        for (int i = 0; i < model.parameters; ++i)
            if (model.held(i)) row[i] = 0;
    }
}

/// A channel of a sample, where the fit is.
struct Residual {
    Eigen::VectorXd row;  ///< of the Jacobian
    double weight;        ///< least squares'
    double influence;     ///< weight psi(r)
};

/// White's covariance of the optimum, where every residual has a variance of its own: `inverse` is that of the
/// normal matrix. A residual whose noise the fit follows by the share h shows 1 - h of its variance.
Eigen::MatrixXd scatter(const Eigen::MatrixXd& inverse, std::span<const Residual> residuals) {
    Eigen::MatrixXd pulls = Eigen::MatrixXd::Zero(inverse.rows(), inverse.cols());
    for (const Residual& r : residuals) {
        const double followed = r.weight * r.row.dot(inverse * r.row);
        constexpr double least = 1e-3;
        pulls.selfadjointView<Eigen::Lower>().rankUpdate(r.row,
                                                         r.influence * r.influence / std::max(least, 1 - followed));
    }
    return inverse * pulls.selfadjointView<Eigen::Lower>() * inverse;
}

}  // namespace

TexelErrorBars texel_error_bars(const TexelModel& model, std::span<const float> p,
                                std::span<const ShadedSample> samples, const Loss& loss) {
    const Eigen::Index n = model.parameters;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    std::vector<Residual> residuals;
    std::vector<double> columns(size_t(model.columns()));
    std::array<Eigen::VectorXd, 3> rows;
    TexelErrorBars out;
    double squares = 0, slope = 0;
    for (const ShadedSample& sample : samples) {
        if (!(sample.weight > 0)) continue;
        ++out.samples;
        model.columns(p, sample.u, sample.v, columns);
        rows_of(model, p, columns, rows);
        const double weight = double(sample.weight);
        Vec3d residual;
        for (size_t c = 0; c < 3; ++c) {
            residual[Eigen::Index(c)] = -double(sample.target[c]);
            for (size_t k = 0; k < size_t(model.basis); ++k)
                residual[Eigen::Index(c)] += double(p[3 * k + c]) * columns[k];
        }
        const double s = weight * residual.squaredNorm();
        const Influence influence = influence_of(loss, s, 3);
        squares += influence.weight * influence.weight * s;
        slope += influence.slope;
        for (size_t c = 0; c < 3; ++c) {
            normal.selfadjointView<Eigen::Lower>().rankUpdate(rows[c], weight);
            residuals.push_back({rows[c], weight, weight * influence.weight * residual[Eigen::Index(c)]});
        }
    }
    std::vector<int> held;
    for (int i = 0; i < model.parameters; ++i)
        if (model.held(i) || i == model.held_by_gauge(p)) held.push_back(i);
    const double unknowns = model.parameters - double(held.size()), values = 3.0 * out.samples;
    if (values <= unknowns) {
        out.covariance = covariance_of(Eigen::MatrixXd::Zero(n, n), 0, held);
        return out;
    }
    slope /= values;
    out.noise = std::sqrt(squares / (values - unknowns)) / slope;
    out.covariance = covariance_of(normal, 1, held);
    out.covariance.matrix = scatter(out.covariance.matrix, residuals) / (slope * slope);
    for (Eigen::Index i = 0; i < n; ++i)
        if (double& deviation = out.covariance.deviation[size_t(i)]; std::isfinite(deviation))
            deviation = std::sqrt(out.covariance.matrix(i, i));
    return out;
}

AllErrorBars::AllErrorBars(const TexelProblem& problem, std::span<const float> parameters)
    : model_(problem.options.model) {
    const size_t texels = problem.source.texel_count(), n = size_t(model_->parameters);
    deviation.resize(texels * n);
    noise.resize(texels);
    deficient.resize(texels);
    triangles_.resize(texels * triangle_size());
    parallel_for(problem.source.block_count(), 1, [&](size_t block, int) {
        TexelSamples samples;
        std::vector<ShadedSample> shaded;
        const size_t begin = block * TexelSource::block;
        problem.source.read(uint32_t(begin), samples);
        for (size_t i = 0; i + 1 < samples.first.size(); ++i) {
            const size_t texel = begin + i;
            problem.loader.load(uint32_t(texel), samples.of(i), shaded);
            if (shaded.empty()) continue;
            const auto bars = texel_error_bars(*model_, parameters.subspan(texel * n, n), shaded, problem.options.loss);
            std::ranges::copy(bars.covariance.deviation, &deviation[texel * n]);
            noise[texel] = float(bars.noise);
            deficient[texel] = uint32_t(bars.covariance.deficient);
            float* entry = &triangles_[texel * triangle_size()];
            for (size_t row = 0; row < n; ++row)
                for (size_t column = 0; column <= row; ++column)
                    *entry++ = float(bars.covariance.matrix(Eigen::Index(row), Eigen::Index(column)));
        }
    });
}

size_t AllErrorBars::triangle_size() const {
    const size_t n = size_t(model_->parameters);
    return n * (n + 1) / 2;
}

std::array<float, 3> AllErrorBars::of_value(uint32_t texel, std::span<const float> p, const Vec3f& u,
                                            const Vec3f& v) const {
    const size_t n = size_t(model_->parameters);
    std::vector<double> columns(size_t(model_->columns()));
    std::array<Eigen::VectorXd, 3> rows;
    model_->columns(p, u, v, columns);
    rows_of(*model_, p, columns, rows);
    std::array<float, 3> out;
    for (size_t c = 0; c < 3; ++c) {
        const float* entry = &triangles_[texel * triangle_size()];
        double variance = 0;
        for (size_t i = 0; i < n; ++i)
            for (size_t j = 0; j <= i; ++j)
                variance += (i == j ? 1 : 2) * double(*entry++) * rows[c][Eigen::Index(i)] * rows[c][Eigen::Index(j)];
        out[c] = float(std::sqrt(std::max(0.0, variance)));
    }
    return out;
}

}  // namespace radiafit
