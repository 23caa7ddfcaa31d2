#include "lightbasis/choose_kernel.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <map>

#include "base/parallel.h"

namespace radiafit::fits {
namespace {

constexpr std::array lengths = {0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.85, 1.0};
constexpr std::array smoothings = {0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2};
// With half vectors, which leave to the lamp what changes slowly, and to themselves a small share.
constexpr std::array lengths_beside_half = {0.5, 0.7, 1.0, 1.4, 2.0};
constexpr std::array half_lengths = {0.1, 0.15, 0.25, 0.4, 0.7};
constexpr std::array half_shares = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3};
constexpr std::array smoothings_beside_half = {0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1};
constexpr double clearly = 0.95;  ///< so much of the squared errors that lamps alone leave

/// Texels that are lit and seen alike, their values side by side.
struct Alike {
    std::vector<LampAndHalf> directions;
    Eigen::MatrixXd values;  ///< [lamps][texels x 3]
};

std::vector<Alike> grouped(const std::vector<LampValues>& texels) {
    std::vector<Alike> groups;
    std::map<const std::vector<LampAndHalf>*, std::vector<const LampValues*>> by_directions;
    std::vector<const std::vector<LampAndHalf>*> order;
    for (const LampValues& texel : texels) {
        auto& members = by_directions[texel.directions];
        if (members.empty()) order.push_back(texel.directions);
        members.push_back(&texel);
    }
    for (const auto* directions : order) {
        const auto& members = by_directions[directions];
        Alike group{*directions, Eigen::MatrixXd(Eigen::Index(directions->size()), Eigen::Index(3 * members.size()))};
        for (size_t i = 0; i < members.size(); ++i)
            group.values.middleCols<3>(Eigen::Index(3 * i)) = members[i]->values->cast<double>();
        groups.push_back(std::move(group));
    }
    return groups;
}

/// Sum of squared errors of values that are left out one by one: row i of K^-1 y over K^-1's entry (i, i).
double left_out_error(const Alike& group, const ChosenKernel& kernel) {
    const Eigen::MatrixXd inverse = lamp_weights(group.directions, kernel, kernel.smoothing);
    const Eigen::MatrixXd weighted = inverse * group.values;
    return (weighted.array().colwise() / inverse.diagonal().array()).square().sum();
}

struct Tried {
    ChosenKernel kernel;
    double error = 0;
};
Tried best_of(const std::vector<ChosenKernel>& kernels, const std::vector<Alike>& groups) {
    std::vector<double> errors(kernels.size(), 0.0);
    parallel_for(errors.size(), 1, [&](size_t i, int) {
        for (const Alike& group : groups) errors[i] += left_out_error(group, kernels[i]);
    });
    const size_t best = size_t(std::ranges::min_element(errors) - errors.begin());
    return {kernels[best], errors[best]};
}

Tried best_of_lamps(const std::vector<Alike>& groups) {
    std::vector<ChosenKernel> kernels;
    for (const double length : lengths)
        for (const double smoothing : smoothings) kernels.push_back({{length}, smoothing});
    return best_of(kernels, groups);
}

/// First the lengths and the share, then the smoothing.
Tried best_with_half(const std::vector<Alike>& groups) {
    constexpr double usual_smoothing = 0.002;
    std::vector<ChosenKernel> kernels;
    for (const double length : lengths_beside_half)
        for (const double half_length : half_lengths)
            for (const double share : half_shares) kernels.push_back({{length, half_length, share}, usual_smoothing});
    const LightKernel<double> best = best_of(kernels, groups).kernel;
    kernels.clear();
    for (const double smoothing : smoothings_beside_half) kernels.push_back({best, smoothing});
    return best_of(kernels, groups);
}

}  // namespace

ChosenKernel choose_kernel(const std::vector<LampValues>& texels, bool with_half) {
    const std::vector<Alike> groups = grouped(texels);
    const Tried of_lamps = best_of_lamps(groups);
    if (!with_half) return of_lamps.kernel;
    const Tried both = best_with_half(groups);
    return both.error < clearly * of_lamps.error ? both.kernel : of_lamps.kernel;
}

}  // namespace radiafit::fits
