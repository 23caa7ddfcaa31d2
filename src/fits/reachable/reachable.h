#pragma once
#include <span>

#include "base/rings.h"
#include "eval/contestant.h"

/// What is reachable: models for comparison, made of the training photographs whenever they are judged. They keep all
/// of them, so that they are no models to store; a fit that comes near them says as much as the photographs can.
namespace radiafit::fits {

struct ReachableModel {
    const char* name;   ///< at the command line and in configs
    const char* words;  ///< in texts
    /// Made from these views; takes the dataset's mesh and cameras, which must outlive the contestant. Throws UserError
    /// for a dataset that no light field map could be fitted to.
    Contestant (*of)(const Dataset& dataset, const std::vector<uint32_t>& views, TargetSpace space);
};
std::span<const ReachableModel> reachable_models();

}  // namespace radiafit::fits
