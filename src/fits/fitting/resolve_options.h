#pragma once
#include <functional>
#include <string>

#include "dataset/dataset.h"
#include "fitting/fit_options.h"

/// What a command line leaves open of a fit, and the dataset decides. Experiments and configs keep the defaults of
/// FitRequest: only commands call this.
namespace radiafit::fits {

/// Median over the surface of the training views that show a place; over a grid, all of them.
double views_per_texel(const Dataset& dataset);

/// A request with these options, the model among them, and what its family chooses by the dataset where they leave it
/// open. Throws UserError.
FitRequest resolved_request(const FitSetting& setting, const Dataset& dataset);

/// Chooses the model where none is given (Family::choose), then has its family choose the rest
/// (Family::resolve_options), and checks the request. given: whether the user gave an option, such as "--terms". Throws
/// UserError.
///
/// Returns what was chosen and why, for people; empty where options that are given left no choice.
std::string resolve_options(const std::function<bool(const char*)>& given, const Dataset& dataset, FitRequest& request);

}  // namespace radiafit::fits
