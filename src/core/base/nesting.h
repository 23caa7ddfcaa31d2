#pragma once
#include <string_view>

namespace radiafit {

/// Whether brackets and braces of a JSON text, those in strings left out, are nested more than `most` deep. Our JSON
/// library writes values out by recursion: a text of brackets alone would use up the stack.
bool nested_deeper(std::string_view text, int most);

}  // namespace radiafit
