#include "base/output_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/leftovers.h"
#include "base/temporary_name.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

/// Whether the open file is still the one of that name: its last holder may have removed it.
bool still_named(int descriptor, const fs::path& file) {
    struct stat open_one, named;
    return fstat(descriptor, &open_one) == 0 && stat(file.c_str(), &named) == 0 && open_one.st_dev == named.st_dev &&
           open_one.st_ino == named.st_ino;
}

}  // namespace

OutputLock::OutputLock(const fs::path& output) {
    const fs::path target = follow_links(output);
    if (!target.has_filename()) return;
    file_ = target.parent_path() / fmt::format("{}-{}", lock_prefix, target.filename().string());
    std::error_code error;
    for (fs::path at = file_.parent_path(); !at.empty() && !fs::exists(at, error); at = at.parent_path())
        made_parents_.push_back(at);
    if (!made_parents_.empty()) fs::create_directories(made_parents_.front(), error);
    constexpr int patience = 20;  // whoever clears leftovers locks a file for a moment, too
    for (int tries = 1;; ++tries) {
        descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (descriptor_ < 0) break;
        if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0) {
            if (still_named(descriptor_, file_)) return;
            close(descriptor_);
            continue;
        }
        const bool held = errno == EWOULDBLOCK;
        close(std::exchange(descriptor_, -1));
        if (!held) break;
        if (tries >= patience) {
            release();
            throw UserError(fmt::format("{}: another run is writing it; wait for that to end, or choose another name",
                                        output.string()));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    release();
}

void OutputLock::release() {
    if (descriptor_ >= 0) {
        unlink(file_.c_str());  // while it is locked: who opened it meanwhile sees that it has lost its name
        close(std::exchange(descriptor_, -1));
    }
    std::error_code ignored;
    for (const fs::path& parent : made_parents_) fs::remove(parent, ignored);  // others may have put something there
}

OutputLock::~OutputLock() { release(); }

}  // namespace radiafit
