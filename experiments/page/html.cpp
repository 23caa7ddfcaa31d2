#include "page/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>

namespace radiafit::harness {
namespace {

constexpr std::string_view unknown = "\xef\xbf\xbd";  // U+FFFD

/// Bytes of the character of UTF-8 that a text starts with; 0: it is none. Neither longer forms than needed nor halves
/// of UTF-16's pairs are any.
size_t character_length(std::string_view text) {
    const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
    const unsigned first = byte(0);
    const size_t length = first < 0x80 ? 1 : first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (length == 1) return 1;
    if (first < 0xc2 || first > 0xf4) return 0;
    for (size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xc0) != 0x80) return 0;
    const unsigned second = byte(1);
    const bool outside = (first == 0xe0 && second < 0xa0) || (first == 0xed && second >= 0xa0) ||
                         (first == 0xf0 && second < 0x90) || (first == 0xf4 && second >= 0x90);
    return outside ? 0 : length;
}

std::string escaped(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const size_t length = character_length(text);
        const std::string_view character = text.substr(0, std::max<size_t>(length, 1));
        const char first = character[0];
        const bool control =
            (static_cast<unsigned char>(first) < 0x20 && first != '\n' && first != '\t') || first == 0x7f;
        if (length == 0 || control)
            out += unknown;
        else if (first == '&')
            out += "&amp;";
        else if (first == '<')
            out += "&lt;";
        else if (first == '>')
            out += "&gt;";
        else if (first == '"')
            out += "&quot;";
        else if (first == '\'')
            out += "&#39;";
        else
            out += character;
        text.remove_prefix(character.size());
    }
    return out;
}

void check_name(std::string_view name) {
    const auto fits = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
    if (name.empty() || !std::ranges::all_of(name, fits))
        throw std::logic_error(fmt::format("'{}' names neither an element nor an attribute of HTML", name));
}

bool has_no_content(std::string_view name) {
    constexpr std::array names = {"br", "col", "hr", "img", "input", "link", "meta"};
    return std::ranges::find(names, name) != names.end();
}

bool within_a_line(std::string_view name) {
    constexpr std::array names = {"a",     "abbr", "b",      "code", "em",  "i",   "q",
                                  "small", "span", "strong", "sub",  "sup", "time"};
    return std::ranges::find(names, name) != names.end();
}

std::string start_tag(std::string_view name, const Attributes& attributes) {
    check_name(name);
    std::string source = fmt::format("<{}", name);
    for (auto attribute = attributes.begin(); attribute != attributes.end(); ++attribute) {
        const auto& [key, value] = *attribute;
        check_name(key);
        if (std::any_of(attributes.begin(), attribute, [&](const auto& other) { return other.first == key; }))
            throw std::logic_error(fmt::format("<{}> has two attributes '{}'", name, key));
        source += fmt::format(" {}=\"{}\"", key, escaped(value));
    }
    return source + '>';
}

bool ends(std::string_view text, std::string_view element) {
    std::string lower(text);
    std::ranges::transform(lower, lower.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    return lower.find(fmt::format("</{}", element)) != std::string::npos || lower.find("<!--") != std::string::npos;
}

}  // namespace

Html::Html(std::string_view text) : source_(escaped(text)) {}

Html Html::raw(std::string source) {
    Html html;
    html.source_ = std::move(source);
    return html;
}

Html element(std::string_view name, const Attributes& attributes, const Html& inside) {
    if (has_no_content(name)) throw std::logic_error(fmt::format("<{}> has no content", name));
    return Html::raw(fmt::format("{}{}</{}>{}", start_tag(name, attributes), inside.source(), name,
                                 within_a_line(name) ? "" : "\n"));
}

Html empty_element(std::string_view name, const Attributes& attributes) {
    if (!has_no_content(name)) throw std::logic_error(fmt::format("<{}> has content", name));
    return Html::raw(start_tag(name, attributes) + "\n");
}

Html style_sheet(std::string_view css) {
    if (ends(css, "style")) throw std::logic_error("a style sheet that ends its own element");
    return Html::raw(fmt::format("<style>\n{}</style>\n", css));
}

Html script(std::string_view javascript) {
    if (ends(javascript, "script")) throw std::logic_error("a script that ends its own element");
    return Html::raw(fmt::format("<script>\n{}</script>\n", javascript));
}

std::string html_page(const Html& head, const Html& body) {
    return fmt::format("<!doctype html>\n<html lang=\"en\">\n{}{}</html>\n", element("head", head).source(),
                       element("body", body).source());
}

std::string data_uri(std::string_view media, std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string uri = fmt::format("data:{};base64,", media);
    for (size_t at = 0; at < bytes.size(); at += 3) {
        const size_t count = std::min<size_t>(3, bytes.size() - at);
        uint32_t block = 0;
        for (size_t i = 0; i < 3; ++i)
            block = block << 8 | (i < count ? static_cast<unsigned char>(bytes[at + i]) : 0U);
        for (size_t i = 0; i < 4; ++i) uri += i <= count ? digits[block >> (18 - 6 * i) & 63] : '=';
    }
    return uri;
}

}  // namespace radiafit::harness
