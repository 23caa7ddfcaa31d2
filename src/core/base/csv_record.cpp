#include "base/csv_record.h"

namespace radiafit {

std::optional<std::vector<std::string>> take_csv_record(std::string_view& text) {
    std::vector<std::string> fields(1);
    size_t at = 0;
    const auto take_quoted = [&](std::string& field) {
        while (at < text.size()) {
            const char c = text[at++];
            if (c == '"') {
                if (at == text.size() || text[at] != '"') return true;
                ++at;
            }
            field += c;
        }
        return false;
    };
    while (at < text.size()) {
        const char c = text[at++];
        std::string& field = fields.back();
        if (c == '"' && field.find_first_not_of(" \t") == std::string::npos) {
            field.clear();
            if (!take_quoted(field)) return std::nullopt;
        } else if (c == ',') {
            fields.emplace_back();
        } else if (c == '\n') {
            break;
        } else if (c != '\r') {
            field += c;
        }
    }
    text.remove_prefix(at);
    return fields;
}

}  // namespace radiafit
