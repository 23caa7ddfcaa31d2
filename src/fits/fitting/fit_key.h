#pragma once
#include <string>

#include "dataset/dataset.h"
#include "fitting/fit_request.h"

namespace radiafit::fits {

/// All that decides a fit's result, as JSON: program, dataset, and the options that do. Parts of a fit, and what an
/// interrupted one left, carry it.
std::string fit_key(const Dataset& dataset, const FitRequest& request);

/// What differs of two keys, for people: "--terms is 2 there, 3 here"; "its dataset has other images". Empty where
/// nothing does.
std::string difference_of_keys(const std::string& there, const std::string& here);

}  // namespace radiafit::fits
