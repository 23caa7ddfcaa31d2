#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace radiafit {

/// Takes a record of comma-separated values (RFC 4180) off the front of a text: its fields, of which quoted ones may
/// hold commas, doubled quotes and line breaks. Blanks before a quote are left out. Nothing, and the text as it was,
/// where a quote is never closed.
std::optional<std::vector<std::string>> take_csv_record(std::string_view& text);

}  // namespace radiafit
