#pragma once
#include <string>
#include <vector>

#include "dataset/dataset.h"
#include "fitting/family.h"

namespace radiafit::fits {

/// How well a fit predicts images that it has not seen.
struct ContestResult {
    FitSetting setting;
    double psnr;  ///< dB, of stored values, pooled
};

/// Fits of models for lamps that move, each to the same few texels, drawn from all of the surface, and without every
/// eighth or so of the images that the request fits, by which they are judged at these texels; each with the options
/// that are given in the request. It takes as long as reading the images once and fitting the texels. Best
/// first; fits that show no numbers are left out.
std::vector<ContestResult> lamp_contest(const Dataset& dataset, const std::vector<FitSetting>& settings,
                                        const Given& given, const FitRequest& request);

}  // namespace radiafit::fits
