#include "reachable/direction_process.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"

namespace radiafit::fits {
namespace {

using Matrix = Eigen::MatrixXd;
using Channels = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Parameters = Eigen::Matrix<double, Evidence::parameters, 1>;

/// sqrt(5) |v - w| / length of all pairs of directions.
Eigen::ArrayXXd distances(const DirectionProcess& process, const SeenColours& seen) {
    Channels v(Eigen::Index(seen.size()), 3);
    for (size_t i = 0; i < seen.size(); ++i) v.row(Eigen::Index(i)) = seen.directions[i].cast<double>().normalized();
    const Matrix cosines = v * v.transpose();
    return (10 - 10 * cosines.array()).max(0).sqrt() / process.length;
}

Eigen::VectorXd noise_variances(const DirectionProcess& process, const SeenColours& seen) {
    Eigen::VectorXd out(Eigen::Index(seen.size()));
    for (size_t i = 0; i < seen.size(); ++i) out[Eigen::Index(i)] = process.noise / double(seen.weights[i]);
    return out;
}

Channels residuals(const DirectionProcess& process, const SeenColours& seen) {
    Channels out(Eigen::Index(seen.size()), 3);
    for (size_t i = 0; i < seen.size(); ++i)
        out.row(Eigen::Index(i)) = (seen.colours[i].cast<double>() - process.mean).transpose();
    return out;
}

DirectionProcess moved(DirectionProcess process, const Parameters& step) {
    process.level *= std::exp(step[0]);
    process.amplitude *= std::exp(step[1]);
    process.length *= std::exp(step[2]);
    process.noise *= std::exp(step[3]);
    return process;
}

/// Sums over chunks of places, added up in their order.
Evidence evidence_of_all(const DirectionProcess& process, const std::vector<SeenColours>& places) {
    constexpr size_t chunk = 32;
    std::vector<Evidence> parts((places.size() + chunk - 1) / chunk);
    parallel_for(parts.size(), 1, [&](size_t part, int) {
        for (size_t i = part * chunk; i < std::min(places.size(), (part + 1) * chunk); ++i)
            parts[part].add(evidence(process, places[i]));
    });
    Evidence sum;
    for (const Evidence& part : parts) sum.add(part);
    return sum;
}

}  // namespace

Channels posterior_weights(const DirectionProcess& process, const SeenColours& seen) {
    Matrix covariance = process.level + process.amplitude * matern(distances(process, seen));
    covariance.diagonal() += noise_variances(process, seen);
    return covariance.llt().solve(residuals(process, seen));
}

void Evidence::add(const Evidence& other) {
    log += other.log;
    gradient += other.gradient;
    information += other.information;
    mean_gradient += other.mean_gradient;
    mean_information += other.mean_information;
}

Evidence evidence(const DirectionProcess& process, const SeenColours& seen) {
    Evidence out;
    const auto n = Eigen::Index(seen.size());
    if (n == 0) return out;
    const Eigen::ArrayXXd r = distances(process, seen);
    // Derivatives of the covariance by the logarithms of the parameters.
    const std::array<Matrix, Evidence::parameters> slopes = {
        Matrix::Constant(n, n, process.level), process.amplitude * matern(r),
        process.amplitude / 3 * r.square() * (1 + r) * (-r).exp(), noise_variances(process, seen).asDiagonal()};
    const Eigen::LLT<Matrix> covariance(slopes[0] + slopes[1] + slopes[3]);
    const Channels residual = residuals(process, seen), weights = covariance.solve(residual);
    const double log_determinant = 2 * covariance.matrixLLT().diagonal().array().log().sum();
    out.log = -0.5 * (residual.cwiseProduct(weights).sum() + 3 * log_determinant +
                      3 * double(n) * std::log(2 * std::numbers::pi));
    std::array<Matrix, Evidence::parameters> relative;  // covariance^-1 slope
    for (size_t k = 0; k < relative.size(); ++k) relative[k] = covariance.solve(slopes[k]);
    for (int k = 0; k < Evidence::parameters; ++k) {
        out.gradient[k] =
            0.5 * (weights.cwiseProduct(slopes[size_t(k)] * weights).sum() - 3 * relative[size_t(k)].trace());
        for (int l = 0; l <= k; ++l) {
            const double trace = relative[size_t(k)].cwiseProduct(relative[size_t(l)].transpose()).sum();
            out.information(k, l) = out.information(l, k) = 1.5 * trace;
        }
    }
    out.mean_gradient = weights.colwise().sum().transpose();
    out.mean_information = covariance.solve(Eigen::VectorXd::Ones(n)).sum();
    return out;
}

DirectionProcess most_likely_process(const std::vector<SeenColours>& places, DirectionProcess start, int rounds) {
    DirectionProcess best = start;
    Evidence at_best = evidence_of_all(best, places);
    double damping = 1e-3;
    for (int round = 0; round < rounds && at_best.mean_information > 0; ++round) {
        Eigen::Matrix<double, Evidence::parameters, Evidence::parameters> damped = at_best.information;
        damped.diagonal() *= 1 + damping;
        const Parameters step = damped.ldlt().solve(at_best.gradient);
        // Fisher's information has no terms between means and covariance.
        DirectionProcess trial = moved(best, step.cwiseMax(-1).cwiseMin(1));
        trial.mean += at_best.mean_gradient / at_best.mean_information;
        const Evidence at_trial = evidence_of_all(trial, places);
        const double gain = at_trial.log - at_best.log;
        damping = gain > 0 ? 0.1 * damping : 10 * damping;
        if (gain > 0) best = trial, at_best = at_trial;
        if (std::abs(gain) < 1e-9 * std::abs(at_best.log) || damping > 1e9) break;
    }
    return best;
}

}  // namespace radiafit::fits
