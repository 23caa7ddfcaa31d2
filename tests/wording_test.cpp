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
}

}  // namespace
}  // namespace radiafit
