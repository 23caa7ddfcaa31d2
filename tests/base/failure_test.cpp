#include "base/failure.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <new>
#include <system_error>

#include "base/error.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

TEST(Failure, TellsTheUsersMistakesFromTheMachines) {
    EXPECT_EQ(describe(UserError("a.ply: empty")).status, 2);
    EXPECT_EQ(describe(SystemError("glFinish")).status, 1);
    EXPECT_EQ(describe(std::bad_alloc()).status, 1);
    EXPECT_NE(describe(std::bad_alloc()).line.find("memory"), std::string::npos);
}

TEST(Failure, APathThatTheSystemRefusesIsTheUsersToMend) {
    const auto refused = [](std::errc why) {
        return describe(fs::filesystem_error("status", "some/path", std::make_error_code(why)));
    };
    for (const std::errc why : {std::errc::too_many_symbolic_link_levels, std::errc::filename_too_long,
                                std::errc::permission_denied, std::errc::not_a_directory})
        EXPECT_EQ(refused(why).status, 2);
    EXPECT_EQ(refused(std::errc::io_error).status, 1);
    EXPECT_EQ(refused(std::errc::filename_too_long).line,
              "some/path: File name too long; check the path and its permissions");
}

}  // namespace
}  // namespace radiafit
