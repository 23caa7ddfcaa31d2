#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/record.h"
#include "base/rings.h"

namespace radiafit {
class AtomicFolder;
}  // namespace radiafit

/// Raw results: ROOT/EXPERIMENT/DEVICE/UTC-REVISION/, written once and never changed.
namespace radiafit::harness {

/// Lower case, letters and digits, one dash for anything else: "llvmpipe (LLVM 15.0.6)" → "llvmpipe-llvm-15-0-6".
std::string slug(const std::string& text);

/// One run's folder. Rows are written below path() while the run goes on; the folder takes its name, with run.json in
/// it, at commit(). A run that fails before leaves nothing, so every folder with a name is a whole run.
class ResultFolder {
public:
    /// `device`: the renderer or "cpu, 2 threads"; it becomes a slug. Throws UserError if the folder can't be made.
    ResultFolder(const std::filesystem::path& root, const std::string& experiment, const std::string& device,
                 Record record);
    ~ResultFolder();
    ResultFolder(ResultFolder&&) noexcept;
    ResultFolder& operator=(ResultFolder&&) noexcept;

    /// Where to write; after commit() the folder under its name.
    const std::filesystem::path& path() const;
    /// What run.json will hold, for facts known only later (GL strings, peaks).
    Record& record() { return record_; }
    /// Adds to run.json "wall_s" and "cpu_s" since the record was made, "peak_memory_bytes" of this process, and
    /// "files" (report/row_files.h).
    void commit();

private:
    std::unique_ptr<AtomicFolder> folder_;
    Record record_;
    bool committed_ = false;
};

/// The folders in a folder, hidden ones (runs under way or broken off) left out; sorted. None where there is no folder.
std::vector<std::filesystem::path> folders_in(const std::filesystem::path& folder);

}  // namespace radiafit::harness
