#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/exact_sum.h"

/// Agree before you time: what a device's passes sum over samples, against the same in double.
namespace radiafit::harness {

enum Quantity { error_sum, gradient_sum, diagonal_sum, gauss_newton_sum, curvature_sum, third_sum, fourth_sum };
inline constexpr std::array quantity_names = {"error", "gradient", "diagonal", "gauss-newton",
                                              "d'Hd",  "third",    "fourth"};

/// Sites are vertices or texels. Each has as many problems as any other (a vertex three), and a range of parameters.
template <class T>
struct SumsOf {
    std::vector<uint32_t> samples = {};  ///< [sites]
    std::array<std::vector<T>, quantity_names.size()> sums =
        {};  ///< by Quantity; gradient, diagonal: [parameters], others
             ///< [problems]; empty: the model has no such sum
};
using DeviceSums = SumsOf<float>;
struct ExactSums : SumsOf<ExactSum> {
    std::vector<size_t> first_parameter;  ///< [sites + 1]
};

/// Sites that took other samples than the list has are left out: a centre on the edge of two pixels may fall into
/// either. A device that takes more other samples than a few rounds its rasterizer's coordinates otherwise, which makes
/// it no less able to fit: it is timed, and marked.
struct Agreement {
    static constexpr double tolerance = 1e-5;           ///< of the sum of terms' magnitudes: some 80 roundings
    static constexpr double most_other_samples = 1e-5;  ///< of all
    static constexpr double most_left_out = 0.1;        ///< of the sites with samples, or too little is compared

    std::array<double, quantity_names.size()> worst{};  ///< difference over magnitudes; infinite where one isn't finite
    uint64_t sites = 0, other_sites = 0;                ///< with samples; of these with other samples than the list
    uint64_t samples = 0, other_samples = 0;            ///< of all sites in the list; more or fewer than there

    double other_share() const { return samples ? double(other_samples) / double(samples) : 0; }
    bool takes_others() const { return other_share() > most_other_samples; }
    /// Where it does not agree, in words; empty where it does.
    std::string disagreement() const;
};
/// Throws std::logic_error where they are not of the same sites.
Agreement compare(const DeviceSums& sums, const ExactSums& exact);

/// The largest relative difference of the errors of two fits' iterations; infinite where one is not finite or lacks.
double fit_difference(const std::vector<double>& errors, const std::vector<double>& reference);

}  // namespace radiafit::harness
