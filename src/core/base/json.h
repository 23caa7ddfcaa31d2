#pragma once
#include <string>
#include <string_view>

/// nlohmann's reader and writer, compiled here once: in every file that calls them they take longer to compile than all
/// else of it. A file that looks into values still includes <nlohmann/json.hpp> itself.
namespace radiafit {

/// Whether brackets and braces of a JSON text, those in strings left out, are nested more than `most` deep. Our JSON
/// library writes values out by recursion: a text of brackets alone would use up the stack.
bool nested_deeper(std::string_view text, int most);

/// Json: nlohmann::ordered_json or nlohmann::json. A text that is no JSON, or nested deeper than `most`, gives a
/// discarded value, which is of no type.
template <class Json>
Json parse_json(std::string_view text, int most = 100);

/// What to do with text that is no UTF-8: throw Json::exception, or write U+FFFD in its place.
enum class NotUtf8 { refuse, replace };

/// indent: blanks a level; -1: all in one line.
template <class Json>
std::string json_text(const Json& value, int indent = -1, NotUtf8 not_utf8 = NotUtf8::refuse);

}  // namespace radiafit
