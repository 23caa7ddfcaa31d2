#pragma once
#include <string>

#include "dataset/dataset.h"
#include "fitting/fit_request.h"

namespace radiafit::fits {

/// All that decides a fit's result, as JSON: program, dataset, and the options that do. Parts of a fit, and what an
/// interrupted one left, carry it.
std::string fit_key(const Dataset& dataset, const FitRequest& request);

/// The revision, and which build of it: the entry "program" of a key.
std::string program_key();

/// What differs of two keys, of fits or of other work with "options", for people: "--terms is 2 there, 3 here"; "its
/// dataset has other images". Empty where nothing does.
std::string difference_of_keys(const std::string& there, const std::string& here);

}  // namespace radiafit::fits
