#pragma once
#include <limits>
#include <span>
#include <vector>

#include "model/texel_model.h"

namespace radiafit {

/// How the sums that the start of a fit needs are spread over sweeps: a group of the model's starts at a time, and of a
/// group's numbers per texel as many as eight targets hold. Their order is that of shaders/reflect/start.frag: products
/// of each basis function that no shape enters (of all but the last, if all are such) with those up to it and with the
/// targets; then for each candidate those of the others.
struct StartLayout {
    explicit StartLayout(const TexelModel& model);
    static constexpr int most_targets = 8;
    int candidates;  ///< of a group; the last group's are filled up with the last start
    int groups;
    int shared, of_candidate;  ///< numbers of all candidates, and of each
    int numbers;               ///< per texel
    int targets() const { return (numbers + 3) / 4; }
    int windows() const { return (targets() + most_targets - 1) / most_targets; }
    int targets_in(int window) const { return std::min(most_targets, targets() - window * most_targets); }
};

/// The best of the model's starts for each texel: coefficients by least squares within their bounds.
class StartSolver {
public:
    StartSolver(const TexelModel& model, size_t texels);
    /// numbers [texels][4 targets()]: the sums of one group, those without samples 0.
    void take(int group, std::span<const float> numbers);
    /// [texels][parameters]; coefficients 0, or as near to it as bounds allow, where there are no samples.
    std::vector<float> parameters() && { return std::move(parameters_); }

private:
    const TexelModel* model_;
    StartLayout layout_;
    std::vector<float> parameters_;
    std::vector<double> lowest_;  ///< [texels] what the best start adds to the error
};

}  // namespace radiafit
