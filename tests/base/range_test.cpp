#include "base/range.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "base/error.h"

namespace radiafit {
namespace {

template <class T>
std::string refusal(std::string_view text, const Range<T>& range) {
    try {
        parse_number("size", text, range);
    } catch (const UserError& e) {
        return e.what();
    }
    return "taken";
}

TEST(Range, TakesBothEndsAndNothingBeyond) {
    constexpr Range<int> range{-2, 16};
    for (const int value : {-2, 0, 16}) EXPECT_EQ(parse_number("size", std::to_string(value), range), value);
    EXPECT_EQ(refusal("17", range), "size = 17: choose a whole number from -2 to 16");
    EXPECT_EQ(refusal("-3", range), "size = -3: choose a whole number from -2 to 16");
}

TEST(Range, TakesTheWholeTextOrNothing) {
    constexpr Range<int> range{0, 16, "0 is off"};
    for (const char* text : {"", " ", " 1", "1 ", "+1", "1.0", "1e1", "0x1", "one", "99999999999999999999"})
        EXPECT_EQ(refusal(text, range),
                  "size = '" + std::string(text) + "': choose a whole number from 0 to 16 (0 is off)");
}

TEST(Range, UnsignedNumbersAreNeverNegativeAndReachTheirLast) {
    constexpr uint64_t last = std::numeric_limits<uint64_t>::max();
    constexpr Range<uint64_t> range{0, last};
    EXPECT_EQ(parse_number("seed", "18446744073709551615", range), last);
    for (const char* text : {"-1", "-0", "18446744073709551616"}) EXPECT_NE(refusal(text, range), "taken") << text;
}

TEST(Range, FractionsAreFiniteAndWithin) {
    constexpr Range<double> range{0, 1e6};
    EXPECT_EQ(parse_number("weight", "1e-3", range), 1e-3);
    EXPECT_EQ(parse_number("weight", "1e6", range), 1e6);
    for (const char* text : {"nan", "inf", "-inf", "-1e-9", "1000001", "1e999", "0,5", "1e", "."})
        EXPECT_NE(refusal(text, range), "taken") << text;
    EXPECT_EQ(refusal("nan", range), "size = nan: choose a number from 0 to 1e+06");
    EXPECT_THROW(require("weight", std::numeric_limits<double>::quiet_NaN(), range), UserError);
}

}  // namespace
}  // namespace radiafit
