#include "lightbasis/choose_kernel.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "lightbasis/light_basis.h"

namespace radiafit::fits {
namespace {

constexpr std::array lengths = {0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.85, 1.0};
constexpr std::array smoothings = {0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2};

/// Texels that are lit alike, their values side by side.
struct Alike {
    const std::vector<Vec3f>* directions;
    Eigen::MatrixXd values;  ///< [lamps][texels x 3]
};

std::vector<Alike> grouped(const std::vector<LampValues>& texels) {
    std::vector<Alike> groups;
    std::map<const std::vector<Vec3f>*, std::vector<const LampValues*>> by_directions;
    std::vector<const std::vector<Vec3f>*> order;
    for (const LampValues& texel : texels) {
        auto& members = by_directions[texel.directions];
        if (members.empty()) order.push_back(texel.directions);
        members.push_back(&texel);
    }
    for (const auto* directions : order) {
        const auto& members = by_directions[directions];
        Alike group{directions, Eigen::MatrixXd(Eigen::Index(directions->size()), Eigen::Index(3 * members.size()))};
        for (size_t i = 0; i < members.size(); ++i)
            group.values.middleCols<3>(Eigen::Index(3 * i)) = members[i]->values->cast<double>();
        groups.push_back(std::move(group));
    }
    return groups;
}

/// Sum of squared errors of values that are left out one by one: row i of K^-1 y over K^-1's entry (i, i).
double left_out_error(const Alike& group, double length, double smoothing) {
    const Eigen::MatrixXd inverse = lamp_weights(*group.directions, length, smoothing);
    const Eigen::MatrixXd weighted = inverse * group.values;
    return (weighted.array().colwise() / inverse.diagonal().array()).square().sum();
}

}  // namespace

ChosenKernel choose_kernel(const std::vector<LampValues>& texels) {
    const std::vector<Alike> groups = grouped(texels);
    std::array<double, lengths.size() * smoothings.size()> errors{};
    parallel_for(errors.size(), 1, [&](size_t i, int) {
        for (const Alike& group : groups)
            errors[i] += left_out_error(group, lengths[i / smoothings.size()], smoothings[i % smoothings.size()]);
    });
    const size_t best = size_t(std::ranges::min_element(errors) - errors.begin());
    return {lengths[best / smoothings.size()], smoothings[best % smoothings.size()]};
}

}  // namespace radiafit::fits
