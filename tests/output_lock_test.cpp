// One run at a time: locks, and what is left of them.
#include "base/output_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "base/error.h"
#include "base/leftovers.h"
#include "base/read_file.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

TEST(OutputLock, TheSecondIsRefusedUntilTheFirstIsGone) {
    const TemporaryFolder folder;
    {
        const OutputLock first(folder.path() / "out");
        EXPECT_THROW(OutputLock(folder.path() / "out"), UserError);
        EXPECT_THROW(OutputLock(folder.path() / "out/"), UserError);
        const OutputLock other(folder.path() / "out2");
    }
    const OutputLock again(folder.path() / "out");
    fs::create_symlink("out", folder.path() / "link");
    EXPECT_THROW(OutputLock(folder.path() / "link"), UserError);
}

TEST(OutputLock, LeavesNothing) {
    const TemporaryFolder folder;
    { const OutputLock lock(folder.path() / "new" / "er" / "out"); }
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(OutputLock, AKilledRunsIsNoObstacleAndGoes) {
    const TemporaryFolder folder;
    const pid_t child = fork();
    if (child == 0) {
        const OutputLock lock(folder.path() / "out");
        _exit(0);  // no destructor, as of a killed one
    }
    waitpid(child, nullptr, 0);
    ASSERT_TRUE(stands(folder.path() / ".radiafit-lock-out"));
    { const OutputLock lock(folder.path() / "out"); }
    EXPECT_TRUE(fs::is_empty(folder.path()));
    std::ofstream(folder.path() / ".radiafit-lock-other");
    const OutputLock mine(folder.path() / "out");
    clear_leftovers(folder.path());
    EXPECT_FALSE(stands(folder.path() / ".radiafit-lock-other"));
    EXPECT_TRUE(stands(folder.path() / ".radiafit-lock-out"));
}

TEST(OutputLock, AFolderThatCanNotBeWrittenIsNoErrorHere) { const OutputLock nowhere("/proc/out"), nameless(""); }

}  // namespace
}  // namespace radiafit
