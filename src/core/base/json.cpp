#include "base/json.h"

#include <nlohmann/json.hpp>

namespace radiafit {

bool nested_deeper(std::string_view text, int most) {
    int depth = 0;
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string && c == '\\') {
            ++i;
        } else if (c == '"') {
            in_string = !in_string;
        } else if (!in_string && (c == '[' || c == '{')) {
            if (++depth > most) return true;
        } else if (!in_string && (c == ']' || c == '}')) {
            --depth;
        }
    }
    return false;
}

template <class Json>
Json parse_json(std::string_view text, int most) {
    return nested_deeper(text, most) ? Json(Json::value_t::discarded) : Json::parse(text, nullptr, false);
}
template nlohmann::json parse_json(std::string_view, int);
template nlohmann::ordered_json parse_json(std::string_view, int);

template <class Json>
std::string json_text(const Json& value, int indent, NotUtf8 not_utf8) {
    using Handler = typename Json::error_handler_t;
    return value.dump(indent, ' ', false, not_utf8 == NotUtf8::replace ? Handler::replace : Handler::strict);
}
template std::string json_text(const nlohmann::json&, int, NotUtf8);
template std::string json_text(const nlohmann::ordered_json&, int, NotUtf8);

}  // namespace radiafit
