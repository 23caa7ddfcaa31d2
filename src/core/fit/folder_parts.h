#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "fit/fit_json.h"

/// What the folders of all fits share.
namespace radiafit {

inline constexpr const char* problems_name = "problems.exr";

/// fit.json's text. Throws UserError.
std::string read_text(const std::filesystem::path& path);
/// Names of the files in a folder, sorted.
std::vector<std::string> names_in(const std::filesystem::path& folder);

/// Throws std::invalid_argument unless it holds.
void require(bool holds, const std::string& what);
/// Throws std::invalid_argument unless a fit to be written has figures of so many problems.
void require_problems(const FitRecord& fit, size_t problems);

/// Throws UserError where there is no such folder; restores one that an interrupted exchange left hidden.
void require_folder(const std::filesystem::path& folder);
/// Throws UserError, naming `problems`, unless the statuses are those that fit.json counted.
void check_promises(const FitRecord& fit, const FitPromises& promises, const std::filesystem::path& problems);

/// The dataset's place as fit.json has it: relative, so that a fit and its dataset can move together; absolute where
/// there is no relative way.
std::string dataset_from(const std::filesystem::path& folder, const FitRecord& fit);

}  // namespace radiafit
