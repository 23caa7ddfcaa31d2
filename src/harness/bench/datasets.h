#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/rings.h"
#include "dataset/dataset.h"

namespace radiafit::harness {

/// The synthetic datasets of a scale, in a temporary folder that is removed with this (TMPDIR says where; in /dev/shm
/// they stay in memory). Engines keep no images but in memory, and read each once.
class BenchDatasets {
public:
    /// Throws UserError for an unknown scale.
    explicit BenchDatasets(const std::string& scale);
    const std::vector<Dataset>& all() const { return datasets_; }

private:
    UnfinishedFolder folder_;
    std::vector<Dataset> datasets_;
};

}  // namespace radiafit::harness
