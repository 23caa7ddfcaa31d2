#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/made_by.h"
#include "base/output_lock.h"

/// A finished output is replaced only by whom its user asks to. Every command claims what it writes before it works.
namespace radiafit {

/// What a command is about to write.
struct OutputTarget {
    std::filesystem::path path;  ///< a file, or a folder
    /// Files that appear together, of which `path` is only what their names have in common; empty: `path` itself.
    std::vector<std::filesystem::path> files = {};
    bool shared = false;   ///< a folder in which other things may stand, too
    bool lock = true;      ///< other runs that write it at the same time are refused; not so ranks of one run
    bool resumed = false;  ///< a folder that its writer compares itself, and goes on from what is there
    /// Throws UserError for what is there and is no output of this kind, which stays whatever the user asks for. None:
    /// only what the same command made may be replaced.
    std::function<void()> check = {};
};

/// What one command of this process writes, from before its work until its end. Writers ask it what they may replace
/// and what they have to say of themselves.
class OutputClaims {
public:
    /// Throws UserError: another run is writing one of them; or one is there, was not made by the same command with
    /// the same key, and the user didn't ask to replace it.
    OutputClaims(std::vector<OutputTarget> targets, MadeBy made, bool replace);
    ~OutputClaims();
    OutputClaims(const OutputClaims&) = delete;
    OutputClaims& operator=(const OutputClaims&) = delete;

    /// Whether all are there, as the same command made them, and not to be made again.
    bool done() const;
    /// The targets, with commas between them.
    std::string names() const;

private:
    struct Claim {
        OutputTarget target;
        std::string place;  ///< by which it is known, whatever its name
        std::unique_ptr<OutputLock> lock;
        bool there = false, done = false;
    };
    void look_at(Claim& claim) const;

    MadeBy made_;
    bool replace_;
    std::vector<Claim> claims_;

    friend bool may_replace_folder(const std::filesystem::path&);
    friend void mark_output(const std::filesystem::path&, const std::filesystem::path&);
    friend void require_replaceable(const std::filesystem::path&);
    friend std::string made_by_remark();
};

// For writers. Where no command claims anything, as in a caller of the library, nothing is marked.

/// Whether a folder was there when it was claimed, and may be replaced.
bool may_replace_folder(const std::filesystem::path& folder);
/// Writes which command made it into a folder that is about to have the name `target`, if that is claimed.
void mark_output(const std::filesystem::path& unfinished, const std::filesystem::path& target);
/// Throws UserError for a file that is there, that the command which is running didn't make, and that is not to be
/// replaced.
void require_replaceable(const std::filesystem::path& file);
/// made_by_word() of the command that is running; empty if there is none.
std::string made_by_remark();

}  // namespace radiafit
