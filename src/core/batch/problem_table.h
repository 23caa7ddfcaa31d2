#pragma once
#include "batch/problem_files.h"

namespace radiafit::batch {

/// A table (CSV) whose first line names its columns (problem_files.h), without starts. Throws UserError "FILE:LINE:
/// ...".
template <class real>
StoredProblems<real> read_problem_table(const std::filesystem::path& file, const ModelText& model);

}  // namespace radiafit::batch
