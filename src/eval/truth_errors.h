#pragma once
#include <string>
#include <vector>

#include "dataset/truth.h"
#include "fit/fit_folder.h"

namespace radiafit {

/// How far a fit's parameters are from a synthetic dataset's truth, in one material.
struct MaterialErrors {
    std::string name;
    uint64_t texels = 0;  ///< with as many samples as the model needs, and finite ones
    double rmse = 0;      ///< of these texels' samples, training views: sqrt(2 sum E / (3 sum samples))
    /// Of a material that the fitted model is the truth of: |p - truth| / |truth| in the canonical gauge.
    bool comparable = false;
    double worst_median = 0;              ///< median over texels of the worst parameter's error
    double worst_90 = 0;                  ///< 90th percentile of the same
    std::vector<std::string> parameters;  ///< as the truth names them
    std::vector<double> median;           ///< [parameters] median over texels
};

/// A parameter log_X of the fit is compared as X = exp(log_X), where the truth has X. Throws UserError if the truth is
/// of another number of texels.
std::vector<MaterialErrors> truth_errors(const ReflectanceFit& fit, const ReflectanceTruth& truth);

}  // namespace radiafit
