#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/rings.h"

/// Pages for browsers, put together from pieces that are well formed whatever text goes in.
namespace radiafit::harness {

/// Text, elements and what is in them. A piece is made of text, which is escaped, or by the functions below.
class Html {
public:
    Html() = default;
    /// Characters with a meaning in HTML are escaped; control characters and invalid UTF-8 become U+FFFD.
    Html(std::string_view text);
    Html(const char* text) : Html(std::string_view(text)) {}
    Html(const std::string& text) : Html(std::string_view(text)) {}

    Html& operator<<(const Html& more) {
        source_ += more.source_;
        return *this;
    }
    const std::string& source() const { return source_; }
    bool empty() const { return source_.empty(); }

private:
    static Html raw(std::string source);
    friend Html element(std::string_view, const std::vector<std::pair<std::string, std::string>>&, const Html&);
    friend Html empty_element(std::string_view, const std::vector<std::pair<std::string, std::string>>&);
    friend Html style_sheet(std::string_view);
    friend Html script(std::string_view);

    std::string source_;
};

using Attributes = std::vector<std::pair<std::string, std::string>>;

/// <name attributes>inside</name>, with a line break behind what is no part of a line of text. Throws std::logic_error
/// for a name that is none (lower-case letters, digits, dashes), for one that occurs twice among the attributes, and
/// for an element that has no content, such as img.
Html element(std::string_view name, const Attributes& attributes, const Html& inside);
inline Html element(std::string_view name, const Html& inside) { return element(name, {}, inside); }

/// An element that has no content. Throws std::logic_error for one that has, and for attributes as element() does.
Html empty_element(std::string_view name, const Attributes& attributes);

/// <style> and <script> with text that is ours. Throw std::logic_error for one that ends the element by itself.
Html style_sheet(std::string_view css);
Html script(std::string_view javascript);

/// A whole file, in English.
std::string html_page(const Html& head, const Html& body);

/// "data:image/png;base64,…": a file within a page. `media`: its type, such as "image/png".
std::string data_uri(std::string_view media, std::string_view bytes);

}  // namespace radiafit::harness
