#pragma once
#include <string>
#include <string_view>

namespace radiafit {

/// The text as any terminal may show it: control characters and what is no UTF-8 are escaped (\n, \x1b).
std::string printable(std::string_view text, bool keep_lines = false);

}  // namespace radiafit
