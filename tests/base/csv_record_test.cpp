// Records of comma-separated values.
#include "base/csv_record.h"

#include <gtest/gtest.h>

namespace radiafit {
namespace {

using Fields = std::vector<std::string>;

Fields first_of(std::string_view text) { return take_csv_record(text).value_or(Fields{"none"}); }

TEST(CsvRecord, FieldsBetweenCommasAndQuotes) {
    EXPECT_EQ(first_of("a,b,c\n"), (Fields{"a", "b", "c"}));
    EXPECT_EQ(first_of("a, b ,\r\nnext"), (Fields{"a", " b ", ""}));
    EXPECT_EQ(first_of("\"a,b\", \"say \"\"c\"\"\",\"two\nlines\""), (Fields{"a,b", "say \"c\"", "two\nlines"}));
    EXPECT_EQ(first_of("5\" pipe,x"), (Fields{"5\" pipe", "x"}));
    EXPECT_EQ(first_of(""), Fields{""});
}

TEST(CsvRecord, OneAfterAnother) {
    std::string_view text = "a,\"b\nc\"\n\nd";
    EXPECT_EQ(take_csv_record(text), (Fields{"a", "b\nc"}));
    EXPECT_EQ(take_csv_record(text), Fields{""});
    EXPECT_EQ(take_csv_record(text), Fields{"d"});
    EXPECT_TRUE(text.empty());
    text = "a,\"never closed\nb";
    EXPECT_FALSE(take_csv_record(text));
    EXPECT_EQ(text, "a,\"never closed\nb");
}

}  // namespace
}  // namespace radiafit
