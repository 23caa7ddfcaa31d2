#include "base/wording.h"

#include <gtest/gtest.h>

namespace radiafit {
namespace {

TEST(Wording, APlainNameUntilAProgramAsksForFlags) {
    EXPECT_EQ(option_name("view-side"), "'view_side'");
    EXPECT_EQ(at_command_line("see `radiafit devices`", "see list_devices()"), "see list_devices()");
    name_options_by_flag();
    EXPECT_EQ(option_name("view-side"), "--view-side");
    EXPECT_EQ(at_command_line("see `radiafit devices`", "see list_devices()"), "see `radiafit devices`");
    name_options_by_flag({{"view-side", "side"}, {"`radiafit devices`", "`program --list`"}});
    EXPECT_EQ(option_name("view-side"), "--side");
    EXPECT_EQ(option_name("surface-side"), "--surface-side");
    EXPECT_EQ(at_command_line("`radiafit devices`", "list_devices()"), "`program --list`");
}

}  // namespace
}  // namespace radiafit
