#pragma once
#include <filesystem>

namespace radiafit {

/// Where this user's programs keep what they can make again: `radiafit` below $XDG_CACHE_HOME, else below ~/.cache
/// (XDG Base Directory Specification). Not made yet. Empty where the user has no home.
std::filesystem::path cache_folder();

}  // namespace radiafit
