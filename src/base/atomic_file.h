#pragma once
#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

/// Outputs appear whole or not at all: they are written under a temporary name beside their place and renamed.
namespace radiafit {

/// A file that takes its name at commit(); destroyed before that, it leaves nothing behind.
/// Throws UserError "cannot write PATH: REASON; choose a writable folder" (a full disk is noticed at commit).
class AtomicFile {
public:
    explicit AtomicFile(std::filesystem::path path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Opened on first use, binary.
    std::ofstream& stream();
    /// For libraries that open files themselves. Same folder, same extension.
    const std::filesystem::path& temporary_path() const { return temporary_; }
    /// `durable` also waits until the data is on the disk (fsync).
    void commit(bool durable = false);

private:
    std::filesystem::path path_;
    std::filesystem::path temporary_;
    std::ofstream stream_;
    bool committed_ = false;
};

void write_file(const std::filesystem::path& path, std::string_view text);

/// A folder that takes its name at commit(): files are written to path() meanwhile. Missing parents are made, and go
/// again without a commit(). What a process that was killed left of the same target goes, too: its folder is locked
/// (flock) as long as it lives, and its name tells the process.
class AtomicFolder {
public:
    /// What to do at commit() with a folder that already has the name. `replace` is for callers who have made sure that
    /// it is an earlier output of theirs.
    enum class Existing { refuse, replace };

    explicit AtomicFolder(std::filesystem::path target, Existing existing = Existing::refuse);
    ~AtomicFolder();
    AtomicFolder(const AtomicFolder&) = delete;
    AtomicFolder& operator=(const AtomicFolder&) = delete;

    /// Where to write before commit().
    const std::filesystem::path& path() const { return temporary_; }
    const std::filesystem::path& target() const { return target_; }
    void commit();

private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    int lock_ = -1;                                    ///< on the temporary folder
    std::vector<std::filesystem::path> made_parents_;  ///< innermost first
    Existing existing_;
    bool committed_ = false;
};

}  // namespace radiafit
