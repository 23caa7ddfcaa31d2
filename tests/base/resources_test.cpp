// What is left of memory and disk, and what happens when it is too little.
#include "base/resources.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "base/error.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {

constexpr uint64_t far_too_much = uint64_t(1) << 60;

std::string complaint(const Needs& needs, const std::filesystem::path& output) {
    try {
        announce_needs("fit", needs, output, false);
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

TEST(Resources, BytesAsPeopleReadThem) {
    EXPECT_EQ(readable_bytes(0), "0 B");
    EXPECT_EQ(readable_bytes(999), "999 B");
    EXPECT_EQ(readable_bytes(1000), "1.0 kB");
    EXPECT_EQ(readable_bytes(999'499), "999 kB");
    EXPECT_EQ(readable_bytes(999'500), "1.0 MB");
    EXPECT_EQ(readable_bytes(1'240'000'000), "1.2 GB");
    EXPECT_EQ(readable_bytes(UINT64_MAX), "18 EB");
}

TEST(Resources, OfThisMachine) {
    const TemporaryFolder folder;
    EXPECT_GT(available_memory(), uint64_t(1) << 20);
    EXPECT_LT(available_memory(), far_too_much);
    EXPECT_GT(free_disk(folder.path()), 0u);
    EXPECT_LT(free_disk(folder.path()), far_too_much);
}

TEST(Resources, ControlGroupsLimitOnlyWhereTheySaySo) {
    const TemporaryFolder folder;
    const auto write = [&](const char* name, const char* text) {
        const std::filesystem::path file = folder.path() / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << text;
    };
    const auto left = [&] { return detail::control_group_memory(folder.path() / "groups", folder.path() / "tree"); };
    EXPECT_EQ(left(), UINT64_MAX) << "no such file";
    write("groups", "1:name=systemd:/elsewhere\n0::/user.slice/session-2.scope\n");
    EXPECT_EQ(left(), UINT64_MAX) << "no such group";
    for (const char* group : {"tree/user.slice", "tree/user.slice/session-2.scope"}) {
        write((std::string(group) + "/memory.max").c_str(), "max\n");
        write((std::string(group) + "/memory.current").c_str(), "5000\n");
    }
    EXPECT_EQ(left(), UINT64_MAX) << "as on a desktop, where no group has a limit";
    write("tree/user.slice/memory.max", "9000\n");
    EXPECT_EQ(left(), 4000u);
    write("tree/user.slice/memory.stat", "anon 3000\nfile 2000\ninactive_file 1500\n");
    EXPECT_EQ(left(), 5500u);
    write("tree/user.slice/session-2.scope/memory.max", "5100\n");
    EXPECT_EQ(left(), 100u);
    write("tree/user.slice/session-2.scope/memory.max", "0\n");
    EXPECT_EQ(left(), 0u);
}

TEST(Resources, OfAFolderThatIsNotThereYet) {
    EXPECT_EQ(free_disk("/proc/none/of/these"), free_disk("/proc"));
    EXPECT_LT(free_disk("none/of/these"), far_too_much);
}

TEST(Resources, TooLittleIsRefusedUnlessForced) {
    EXPECT_EQ(complaint({1000, 1000}, "out"), "");
    const std::string memory = complaint({far_too_much, 1000}, "out"), disk = complaint({1000, far_too_much}, "out");
    EXPECT_NE(memory.find("fit needs about 1.2 EB of memory"), std::string::npos) << memory;
    EXPECT_NE(memory.find("choose smaller sizes"), std::string::npos) << memory;
    EXPECT_NE(disk.find("of disk for out"), std::string::npos) << disk;
    EXPECT_NE(disk.find("make room"), std::string::npos) << disk;
    EXPECT_NE(disk.find("'force'"), std::string::npos) << disk;
    EXPECT_NO_THROW(announce_needs("fit", {far_too_much, far_too_much}, "out", true));
}

TEST(Resources, ALimitOnAddressSpaceCounts) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the sanitizers' shadow memory takes more address space than the limit";
#endif
    const pid_t child = fork();
    if (child == 0) {
        constexpr uint64_t limit = uint64_t(8) << 30;
        const rlimit space{limit, limit};
        setrlimit(RLIMIT_AS, &space);
        _exit(available_memory() < limit ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace radiafit
