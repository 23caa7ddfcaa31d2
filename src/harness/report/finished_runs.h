#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/rings.h"

namespace radiafit::harness {

inline constexpr const char* run_record_name = "run.json";

/// One folder that an experiment left, by its run.json.
struct RunRecord {
    std::filesystem::path folder;
    std::string experiment, utc, revision, profile, compiler, cpu;
    std::string renderer = {};  ///< OpenGL's, where it made rows
    std::string caption = {};   ///< of its figure; empty in older runs
    int cores = 0, threads = 0;
    bool standard = true;                            ///< by the checkout's config file, with nothing else set
    bool rounds_left_out = false;                    ///< as its time was up
    std::map<std::string, std::string> config = {};  ///< resolved, values as JSON
    std::map<std::string, std::string> files = {};   ///< what row_files.h knows each by; empty: no list was made

    std::string device() const;  ///< "AMD EPYC, 2 cores, 2 threads; llvmpipe"
    /// Whether the same was run on the same machine, so that times mean the same.
    bool alike(const RunRecord& other) const {
        return experiment == other.experiment && device() == other.device() && profile == other.profile &&
               config == other.config;
    }
    /// Whether both measured the same program, too. Two builds of one revision that has changed files need not be the
    /// same.
    bool repeats(const RunRecord& other) const {
        return alike(other) && revision == other.revision && compiler == other.compiler &&
               !revision.ends_with("-dirty");
    }
};

/// The run whose folder this is. Throws UserError for a run.json that is missing, damaged, or of an older version.
RunRecord read_run(const std::filesystem::path& folder);

/// The run whose folder this is, or all standard runs in it up to three levels down (EXPERIMENT/DEVICE/RUN); hidden
/// folders, in which runs are under way or were broken off, left out. The newest first. Throws UserError: no such
/// folder, no run, rows without their run.json, or one that is damaged.
std::vector<RunRecord> find_runs(const std::filesystem::path& folder);

/// The newest standard run of an experiment and profile on each device, in the order of ROOT/EXPERIMENT's folders; one
/// that was cut short only where there is no other. Those that read_run() refuses are left out.
std::vector<RunRecord> newest_runs(const std::filesystem::path& root, const std::string& experiment,
                                   const std::string& profile);

/// The newest run of each device and each set of other settings than the checkout's, such as another object's.
std::vector<RunRecord> varied_runs(const std::filesystem::path& root, const std::string& experiment,
                                   const std::string& profile);

}  // namespace radiafit::harness
