#pragma once
#include <cstdint>
#include <limits>
#include <optional>

namespace radiafit {

/// A JSON value (nlohmann's) that is a whole number of 32 bits, or nothing. nlohmann's conversion of other numbers,
/// such as 1e30, is undefined.
template <class Json>
std::optional<uint32_t> whole_number(const Json& value) {
    if (!value.is_number_unsigned()) return {};
    const auto number = value.template get<uint64_t>();
    if (number > std::numeric_limits<uint32_t>::max()) return {};
    return static_cast<uint32_t>(number);
}

}  // namespace radiafit
