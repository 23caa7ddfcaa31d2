#include "base/range.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <type_traits>

#include "base/error.h"

namespace radiafit {
namespace {

template <class T>
std::string plain(T value) {
    if constexpr (std::is_floating_point_v<T>) return fmt::format("{:g}", value);
    return fmt::format("{}", value);
}

}  // namespace

template <class T>
std::string advice(const Range<T>& range) {
    const std::string note = range.note;
    return fmt::format("choose a {} from {} to {}{}", std::is_floating_point_v<T> ? "number" : "whole number",
                       plain(range.lower), plain(range.upper), note.empty() ? "" : " (" + note + ")");
}

template <class T>
void require(std::string_view name, T value, const Range<T>& range) {
    if (!(value >= range.lower && value <= range.upper))
        throw UserError(fmt::format("{} = {}: {}", name, plain(value), advice(range)));
}

template <class T>
T parse_number(std::string_view name, std::string_view text, const Range<T>& range) {
    T value{};
    const char* end = text.data() + text.size();
    const auto [stopped, code] = std::from_chars(text.data(), end, value);
    if (code != std::errc() || stopped != end) throw UserError(fmt::format("{} = '{}': {}", name, text, advice(range)));
    require(name, value, range);
    return value;
}

#define RADIAFIT_RANGE_OF(T)                                                \
    template std::string advice(const Range<T>& range);                     \
    template void require(std::string_view name, T value, const Range<T>&); \
    template T parse_number(std::string_view name, std::string_view text, const Range<T>&);
RADIAFIT_RANGE_OF(int)
RADIAFIT_RANGE_OF(int64_t)
RADIAFIT_RANGE_OF(uint64_t)
RADIAFIT_RANGE_OF(double)
#undef RADIAFIT_RANGE_OF

}  // namespace radiafit
