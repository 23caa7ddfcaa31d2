#pragma once
#include <string>
#include <string_view>

/// Rules for numbers that a user gives: stated once, beside what they are about, and checked where a number is read.
namespace radiafit {

/// The values that an option, a key of a config file or a field may have. T: int, int64_t, uint64_t or double.
template <class T>
struct Range {
    T lower, upper;         ///< both included; NaN is never within
    const char* note = "";  ///< what a value means that isn't plain, such as "0 is off"
};

/// "choose a whole number from 1 to 16".
template <class T>
std::string advice(const Range<T>& range);

/// Throws UserError "NAME = VALUE: choose ..." for a value that isn't within.
template <class T>
void require(std::string_view name, T value, const Range<T>& range);

/// The number that all of `text` writes. Throws UserError "NAME = 'TEXT': choose ..." where there is none, or one that
/// isn't within.
template <class T>
T parse_number(std::string_view name, std::string_view text, const Range<T>& range);

}  // namespace radiafit
