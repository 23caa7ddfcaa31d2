#pragma once
#include <filesystem>
#include <vector>

namespace radiafit {

/// One run at a time writes an output: a lock on a hidden file beside it, `.radiafit-lock-NAME`, that goes with the
/// run, however it ends. The file itself goes, too, but for a killed run's, which the next one there removes
/// (leftovers.h). Missing parents are made, and go again while nothing is in them.
class OutputLock {
public:
    /// Throws UserError where another run holds it. A folder that can't be written, or has no locks, is no error here.
    explicit OutputLock(const std::filesystem::path& output);
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

private:
    void release();

    std::filesystem::path file_;
    std::vector<std::filesystem::path> made_parents_;  ///< innermost first
    int descriptor_ = -1;
};

}  // namespace radiafit
