#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/file.h"

/// Outputs appear atomically: they are written under hidden names beside their places and renamed, and are on
/// the disk (fsync) before they are. All throw UserError as throw_unwritable() does, and leave what was there before.
/// What a run that was killed left in a folder goes when the next one writes there.
namespace radiafit {

/// A file that takes its name at commit(); destroyed before that, it leaves nothing behind. A library that opens files
/// itself should write to memory instead: it may not notice what the disk refuses.
class AtomicFile {
public:
    explicit AtomicFile(std::filesystem::path path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(std::string_view bytes) { out_.write(bytes.data(), bytes.size()); }
    /// In a folder that isn't whole itself, syncing is left to that folder's commit.
    void commit();

private:
    std::filesystem::path path_;
    std::filesystem::path temporary_;
    OutputFile out_;
    bool committed_ = false;
};

/// `bytes`: text or not.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// A hidden folder, locked as long as it lives; goes with all that is in it. Missing parents are made, and go again
/// while nothing is in them.
class UnfinishedFolder {
public:
    /// In `parent`. `name`: what files in it are to be known by in messages, as parent/name/FILE, or parent/FILE.
    UnfinishedFolder(const std::filesystem::path& parent, const std::string& name);
    ~UnfinishedFolder();
    UnfinishedFolder(const UnfinishedFolder&) = delete;
    UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Waits until all that is in it is on the disk; left to the outer one if it lies in another.
    void sync() const;
    /// What was in it has its names now, and they are on the disk; whatever path() still names goes.
    void release();

private:
    void make();
    void make_parents(std::error_code& error);
    void remove_made_parents() const;

    std::filesystem::path path_;
    std::vector<std::filesystem::path> made_parents_;  ///< innermost first
    int lock_ = -1;
    bool released_ = false;
};

/// A folder that takes its name at commit(): files are written to path() meanwhile. An earlier folder of the name is
/// exchanged for it in one step (renameat2), so that there is always a whole one, and of several writers the last wins.
/// Where the file system cannot do that, a process killed between two renames leaves the earlier one hidden;
/// restore_interrupted() and the next writer give it its name back.
class AtomicFolder {
public:
    /// What to do at commit() with a folder that already has the name. `replace` is for callers who have made sure that
    /// it is an earlier output of theirs. What the running command has claimed (output_claims.h) is replaced in any
    /// case, and marked.
    enum class Existing { refuse, replace };

    /// Refuses names that no folder can be renamed to: empty, ".", "..", a mount point.
    explicit AtomicFolder(std::filesystem::path target, Existing existing = Existing::refuse);

    /// Where to write before commit().
    const std::filesystem::path& path() const { return work_.path(); }
    const std::filesystem::path& target() const { return target_; }
    void commit();

private:
    void refuse_existing(const char* what) const;
    void exchange();
    void rename_twice();

    std::filesystem::path target_;
    UnfinishedFolder work_;
    Existing existing_;
};

/// Files that take their names in one folder together, over earlier files of the same names: all or, after an error,
/// none. A folder that the running command has claimed is marked with the last of them. (A process that is killed amid
/// the renames leaves some whole new ones and some whole older ones; and after an error on a file system without
/// renameat2's exchange, older ones that were replaced already don't come back.)
class AtomicFiles {
public:
    explicit AtomicFiles(std::filesystem::path folder);

    /// Where to write the files before commit().
    const std::filesystem::path& path() const { return work_.path(); }
    void commit();

private:
    /// Exchanges the files with earlier ones, which an error brings back from path().
    void place(const std::vector<std::filesystem::path>& names);

    std::filesystem::path folder_;
    UnfinishedFolder work_;
};

}  // namespace radiafit
