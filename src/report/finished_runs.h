#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace radiafit {

/// One folder that an experiment left, by its run.json.
struct RunRecord {
    std::filesystem::path folder;
    std::string experiment, utc, revision, profile, compiler;
    std::string device;                         ///< "AMD EPYC, 2 cores, 2 threads; llvmpipe"
    std::map<std::string, std::string> config;  ///< resolved, values as JSON

    /// Whether the same was run on the same machine, so that times mean the same.
    bool alike(const RunRecord& other) const {
        return experiment == other.experiment && device == other.device && profile == other.profile &&
               config == other.config;
    }
    /// Whether both measured the same program, too. Two builds of one revision that has changed files need not be the
    /// same.
    bool repeats(const RunRecord& other) const {
        return alike(other) && revision == other.revision && compiler == other.compiler &&
               !revision.ends_with("-dirty");
    }
};

/// A run's own folder, or all runs in a folder up to three levels down (EXPERIMENT/DEVICE/RUN); hidden folders, in
/// which runs are under way or were broken off, left out. The newest first. Throws UserError: no such folder, no run,
/// rows without their run.json, or one that is damaged.
std::vector<RunRecord> find_runs(const std::filesystem::path& folder);

}  // namespace radiafit
