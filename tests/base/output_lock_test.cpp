// One run at a time writes an output, whatever its name looks like, and a run that was killed is in nobody's way.
#include "base/output_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

TEST(OutputLock, TheSecondIsRefusedUntilTheFirstIsGone) {
    const TemporaryFolder folder;
    {
        const OutputLock first(folder.path() / "new" / "out");
        EXPECT_THROW(OutputLock(folder.path() / "new" / "out"), UserError);
        EXPECT_THROW(OutputLock(folder.path() / "new" / "out/"), UserError);
        EXPECT_THROW(OutputLock(folder.path() / "new" / ".." / "new" / "out"), UserError);
        const OutputLock other(folder.path() / "new" / "out2");
    }
    EXPECT_TRUE(fs::is_empty(folder.path()));
    const OutputLock again(folder.path() / "new" / "out");
    fs::create_directory(folder.path() / "new");
    fs::create_symlink("new/out", folder.path() / "link");
    EXPECT_THROW(OutputLock(folder.path() / "link"), UserError);
}

TEST(OutputLock, GoesWithItsProcess) {
    const TemporaryFolder folder;
    int ready[2];
    ASSERT_EQ(pipe(ready), 0);
    const pid_t child = fork();
    if (child == 0) {
        const OutputLock lock(folder.path() / "out");
        _exit(write(ready[1], "x", 1) == 1 && pause() ? 0 : 1);
    }
    char byte;
    ASSERT_EQ(read(ready[0], &byte, 1), 1);
    EXPECT_THROW(OutputLock(folder.path() / "out"), UserError);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const OutputLock lock(folder.path() / "out");
    close(ready[0]);
    close(ready[1]);
}

}  // namespace
}  // namespace radiafit
