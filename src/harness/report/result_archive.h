#pragma once
#include <filesystem>
#include <memory>

#include "base/atomic_file.h"
#include "base/rings.h"

/// Results in one file, as they travel from machine to machine: a tar archive, written and read by the program tar.
namespace radiafit::harness {

/// The folder becomes the archive's `results`; what is unfinished in it is left out. The file appears whole or not at
/// all. Throws UserError where it can't be written, SystemError where there is no tar.
void write_result_archive(const std::filesystem::path& folder, const std::filesystem::path& file);

/// A folder of runs, or an archive of one, unpacked as long as this lives.
class UnpackedResults {
public:
    /// Throws UserError for what is neither.
    explicit UnpackedResults(const std::filesystem::path& folder_or_archive);
    const std::filesystem::path& folder() const { return folder_; }

private:
    std::unique_ptr<UnfinishedFolder> unpacked_;
    std::filesystem::path folder_;
};

}  // namespace radiafit::harness
