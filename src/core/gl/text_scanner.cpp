#include "gl/text_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>
#include <utility>

#include "base/error.h"

namespace radiafit {
namespace {

std::string without_comments(const std::string& text) {
    std::string out;
    for (size_t i = 0; i < text.size();) {
        if (text.compare(i, 2, "//") == 0) {
            i = std::min(text.find('\n', i), text.size());
        } else if (text.compare(i, 2, "/*") == 0) {
            const size_t end = text.find("*/", i + 2);
            const size_t stop = end == std::string::npos ? text.size() : end + 2;
            out += ' ';
            out.append(size_t(std::count(text.begin() + std::ptrdiff_t(i), text.begin() + std::ptrdiff_t(stop), '\n')),
                       '\n');
            i = stop;
        } else {
            out += text[i++];
        }
    }
    return out;
}

}  // namespace

bool Token::name() const { return std::isalpha(uint8_t(text[0])) || text[0] == '_'; }

bool TextScanner::has_function(const std::string& name) const {
    for (size_t i = 1; i + 1 < tokens_.size(); ++i)
        if (tokens_[i].text == name && tokens_[i + 1].text == "(" && tokens_[i - 1].name()) return true;
    return false;
}

void refuse_text(const std::string& file, int line, const std::string& what) {
    throw UserError(fmt::format("{}:{}: {}", file, line, what));
}

void TextScanner::scan(const std::string& text) {
    const std::string plain = without_comments(text);
    std::istringstream lines(plain);
    int number = 0, only_cpp = 0;  // depth of conditionals within #ifdef __cplusplus
    for (std::string line; std::getline(lines, line);) {
        ++number;
        const size_t first = line.find_first_not_of(" \t\r");
        if (first == std::string::npos) continue;
        if (line[first] != '#') {
            if (only_cpp == 0) add_tokens(line, number);
            continue;
        }
        std::istringstream words(line.substr(first + 1));
        std::string directive, rest;
        words >> directive;
        std::getline(words >> std::ws, rest);
        if (directive.starts_with("if") && (only_cpp > 0 || (directive == "ifdef" && rest.starts_with("__cplusplus"))))
            ++only_cpp;
        else if (directive == "endif" && only_cpp > 0)
            --only_cpp;
        else if (only_cpp > 0)
            continue;
        else if (directive == "define")
            define(rest, number);
        else if (directive == "include")
            include(rest, number);
        else
            not_in_dialect(number, "#" + directive);
    }
    if (only_cpp > 0) refuse_text(file_, number, "an #ifdef __cplusplus without its #endif");
}

void TextScanner::add_tokens(const std::string& line, int number) {
    static constexpr std::string_view pairs[] = {"+=", "-=", "*=", "/=", "++", "--",
                                                 "<=", ">=", "==", "!=", "&&", "||"};
    const auto word = [](char c) { return std::isalnum(uint8_t(c)) || c == '_'; };
    for (size_t i = 0; i < line.size();) {
        const char c = line[i];
        size_t end = i + 1;
        if (std::isspace(uint8_t(c))) {
            i = end;
            continue;
        }
        const bool number_begins =
            std::isdigit(uint8_t(c)) || (c == '.' && end < line.size() && std::isdigit(uint8_t(line[end])));
        if (number_begins)
            while (end < line.size() &&
                   (word(line[end]) || line[end] == '.' ||
                    ((line[end] == '-' || line[end] == '+') && (line[end - 1] == 'e' || line[end - 1] == 'E'))))
                ++end;
        else if (word(c))
            while (end < line.size() && word(line[end])) ++end;
        else if (std::ranges::find(pairs, std::string_view(line).substr(i, 2)) != std::end(pairs))
            end = i + 2;
        else if (std::string_view("+-*/<>=!(){}[];,.").find(c) == std::string_view::npos)
            not_in_dialect(number, fmt::format("'{}'", c));
        tokens_.push_back({line.substr(i, end - i), number});
        i = end;
    }
}

void TextScanner::not_in_dialect(int number, const std::string& what) {
    if (unknown_.line == 0) unknown_ = {file_, number, what + " is not in the dialect of models"};
}

void TextScanner::define(const std::string& rest, int number) {
    const size_t end = std::min(rest.find_first_of(" \t("), rest.size());
    if (end < rest.size() && rest[end] == '(') return not_in_dialect(number, "a macro with arguments");
    std::string value = rest.substr(std::min(rest.find_first_not_of(" \t", end), rest.size()));
    value.erase(value.find_last_not_of(" \t\r") + 1);
    defined_[rest.substr(0, end)] = value;
}

void TextScanner::include(const std::string& rest, int number) {
    const size_t open = rest.find('"'), close = open == std::string::npos ? open : rest.find('"', open + 1);
    if (close == std::string::npos) refuse_text(file_, number, "#include needs a file in quotes");
    const std::string name = rest.substr(open + 1, close - open - 1);
    if (!included_.insert(name).second) return;
    const std::string file = std::exchange(file_, name);
    scan(read_(name));
    file_ = file;
}

}  // namespace radiafit
