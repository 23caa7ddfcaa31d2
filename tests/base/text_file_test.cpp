// Text as editors of all systems leave it.
#include "base/text_file.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace radiafit {
namespace {

std::vector<std::string> lines_of(std::string text) {
    TextFile file("list.txt", std::move(text), 0);
    std::vector<std::string> lines;
    for (std::string_view line; file.next_line(line);) lines.emplace_back(line);
    return lines;
}

std::string complaint_about(std::string text) {
    try {
        lines_of(std::move(text));
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

/// UTF-16 of a text of up to 16-bit characters, with its mark.
std::string utf16(std::u16string_view text, bool big_endian) {
    std::string bytes;
    for (const char16_t unit : u'\ufeff' + std::u16string(text)) {
        const char high = static_cast<char>(unit >> 8), low = static_cast<char>(unit & 0xff);
        bytes += big_endian ? high : low;
        bytes += big_endian ? low : high;
    }
    return bytes;
}

TEST(TextFile, LinesEndAsAnySystemEndsThem) {
    const std::vector<std::string> lines = {"1 2", "", "3"};
    for (const char* text : {"1 2\n\n3\n", "1 2\r\n\r\n3\r\n", "1 2\r\r3\r", " 1 2\t\n\n3", "1 2\r\n\r\n3"})
        EXPECT_EQ(lines_of(text), lines) << text;
}

TEST(TextFile, ByteOrderMarksAreNoPartOfTheText) {
    const std::vector<std::string> lines = {"24", "M\u00fcnze \U0001F4F7 1 2 3"};
    EXPECT_EQ(lines_of("\xef\xbb\xbf"
                       "24\nM\u00fcnze \U0001F4F7 1 2 3\n"),
              lines);
    for (const bool big : {false, true})
        EXPECT_EQ(lines_of(utf16(u"24\r\nM\u00fcnze \U0001F4F7 1 2 3\r\n", big)), lines);
    EXPECT_EQ(lines_of("\xef\xbb\xbf"), std::vector<std::string>());
}

TEST(TextFile, DamagedTextIsNamed) {
    for (const bool big : {false, true}) {
        const std::string text = utf16(u"24 lamps of a dome\n", big);
        EXPECT_EQ(complaint_about(text.substr(2)), "list.txt: UTF-16 text without a byte order mark: save it as UTF-8");
        EXPECT_EQ(complaint_about(text.substr(0, text.size() - 1)),
                  "list.txt: damaged UTF-16 text: save it again, as UTF-8");
        EXPECT_NE(complaint_about(utf16(std::u16string(1, char16_t(0xdc00)), big)), "");  // the second of a pair alone
        EXPECT_NE(complaint_about(utf16(std::u16string(1, char16_t(0xd83d)), big)), "");  // the first alone
    }
    const std::string zeros = "list.txt: holds zero bytes, so it is no text or a damaged one: write it again";
    EXPECT_EQ(complaint_about(std::string("1 2\n") + std::string(100, '\0')), zeros);
    EXPECT_EQ(complaint_about(std::string(64, '\0')), zeros);
}

TEST(TextFile, ComplaintsSayWhereTheFileIsCut) {
    TextFile file("list.txt", "1\n# two\n3x", 0);
    std::string_view line;
    ASSERT_TRUE(file.next_entry(line));
    EXPECT_TRUE(file.ended());
    ASSERT_TRUE(file.next_entry(line));
    EXPECT_FALSE(file.ended());
    try {
        file.to_unsigned(line, "a number");
        FAIL();
    } catch (const UserError& error) {
        EXPECT_STREQ(error.what(),
                     "list.txt:3: the file ends within this line: copy or write it again (a number is '3x', which is "
                     "no whole number: correct the line)");
    }
}

}  // namespace
}  // namespace radiafit
