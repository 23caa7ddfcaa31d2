#include "base/wording.h"

#include <gtest/gtest.h>

namespace radiafit {
namespace {

[[noreturn]] void ask_for_flags_and_exit() {
    EXPECT_EQ(option_name("view-side"), "'view_side'");
    EXPECT_EQ(at_command_line("see `radiafit devices`", "see list_devices()"), "see list_devices()");
    name_options_by_flag();
    EXPECT_EQ(option_name("view-side"), "--view-side");
    EXPECT_EQ(at_command_line("see `radiafit devices`", "see list_devices()"), "see `radiafit devices`");
    name_options_by_flag({{"view-side", "side"}, {"`radiafit devices`", "`program --list`"}});
    EXPECT_EQ(option_name("view-side"), "--side");
    EXPECT_EQ(option_name("surface-side"), "--surface-side");
    EXPECT_EQ(at_command_line("`radiafit devices`", "list_devices()"), "`program --list`");
    std::exit(::testing::Test::HasFailure() ? 1 : 0);
}

// In a process of its own, which starts anew: nothing takes the flags back from a program that asked for them.
TEST(Wording, APlainNameUntilAProgramAsksForFlags) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(ask_for_flags_and_exit(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace radiafit
