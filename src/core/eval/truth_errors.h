#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "dataset/truth.h"
#include "fit/fit_folder.h"

namespace radiafit {

/// Compares a texel's parameters with a material's truth, by name: a model's log_X as X = exp(log_X), where the truth
/// has X. Both are in the canonical gauge.
class TruthComparison {
public:
    TruthComparison(const TexelModel& model, const TruthMaterial& material);
    /// Whether the material is of this very model; else there is nothing to compare.
    bool possible() const { return possible_; }
    const std::string& name(size_t i) const { return parameters_[i].name; }  ///< of parameter i, as the truth has it
    /// |p - truth| / |truth| of parameter i.
    double error(size_t i, std::span<const float> p, const std::array<float, 9>& truth) const;
    /// What parameter i is in truth, as a fit has it.
    double truth_of(size_t i, const std::array<float, 9>& truth) const;
    /// The largest of a texel's errors; NaN unless possible().
    double worst(std::span<const float> p, const std::array<float, 9>& truth) const;

private:
    struct Parameter {
        std::string name;
        bool logarithm;
        size_t at;  ///< among the truth's numbers
    };
    std::vector<Parameter> parameters_;
    bool possible_;
};

/// How many of some values lie within their error bars.
struct TruthShare {
    uint64_t values = 0, within = 0;
    void add(const TruthShare& other) { values += other.values, within += other.within; }
    double share() const { return double(within) / double(values); }
};

/// How far a fit's parameters are from a synthetic dataset's truth, in one material.
struct MaterialErrors {
    std::string name;
    uint64_t texels = 0;  ///< with as many samples as the model needs, and finite ones
    double rmse = 0;      ///< of these texels' samples, training views: sqrt(2 sum E / (3 sum samples))
    /// Whether the truth is of the fitted model. Then errors are |p - truth| / |truth| in the canonical gauge.
    bool comparable = false;
    double worst_median = 0;              ///< median over texels of the worst parameter's error
    double worst_90 = 0;                  ///< 90th percentile of the same
    std::vector<std::string> parameters;  ///< as the truth names them
    std::vector<double> median;           ///< [parameters] median over texels
    /// [parameters] texels whose parameter has a standard deviation (not held by the gauge, determined by the samples),
    /// and how many of these are no further than that from the truth: 0.68 of them, where error bars are true.
    std::vector<TruthShare> within;
    TruthShare within_all() const;
};

/// deviations: standard deviations of the fit's parameters, if known. Throws UserError if the truth is of another
/// number of texels than the dataset that was fitted.
std::vector<MaterialErrors> truth_errors(const ReflectanceFit& fit, const ReflectanceTruth& truth,
                                         std::span<const float> deviations = {});

}  // namespace radiafit
