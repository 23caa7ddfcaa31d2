#include "base/printable.h"

#include <gtest/gtest.h>

namespace radiafit {
namespace {

TEST(Printable, LeavesWhatPeopleReadAlone) {
    for (const char* text : {"", "plain text: 100 %", "grün, 光, \xf0\x9f\x8e\xa8", "back\\slash"})
        EXPECT_EQ(printable(text), text);
}

TEST(Printable, EscapesWhatATerminalActsOn) {
    EXPECT_EQ(printable("two\nlines\r\t"), "two\\nlines\\x0d\\x09");
    EXPECT_EQ(printable("\x1b[31mred\x1b[0m\x07\x7f"), "\\x1b[31mred\\x1b[0m\\x07\\x7f");
    EXPECT_EQ(printable("C1 \xc2\x9b"), "C1 \\xc2\\x9b");
    EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
}

TEST(Printable, EscapesWhatIsNoText) {
    EXPECT_EQ(printable("\xff\xfe"), "\\xff\\xfe");
    EXPECT_EQ(printable("cut \xe5\x85"), "cut \\xe5\\x85");
    EXPECT_EQ(printable("overlong \xc0\xaf"), "overlong \\xc0\\xaf");
    EXPECT_EQ(printable("\x80ü"), "\\x80ü");
}

TEST(Printable, KeepsLinesWhereAskedTo) { EXPECT_EQ(printable("a\nb\r\n", true), "a\nb\\x0d\n"); }

}  // namespace
}  // namespace radiafit
