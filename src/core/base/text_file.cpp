#include "base/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/read_file.h"

namespace radiafit {
namespace {
constexpr std::string_view blanks = " \t\r";

std::string_view trimmed(std::string_view line) {
    const size_t first = line.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return line.substr(first, line.find_last_not_of(blanks) - first + 1);
}

/// The whole token, or an error. from_chars takes no plus sign, but some writers set one.
template <class T>
std::errc parse(std::string_view token, T& value) {
    if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
    const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), value);
    return end == token.data() + token.size() ? code : std::errc::invalid_argument;
}
}  // namespace

TextFile::TextFile(const std::filesystem::path& file, const std::string& what)
    : TextFile(file, read_file(file, what), 0) {}

TextFile::TextFile(std::filesystem::path file, std::string text, size_t lines_before)
    : file_(std::move(file)), text_(std::move(text)), number_(lines_before) {
    if (text_.find('\0') != std::string::npos)
        throw UserError(
            fmt::format("{}: holds zero bytes, so it is no text or a damaged one: write it again", file_.string()));
    if (text_.find('\r') != std::string::npos && text_.find('\n') == std::string::npos)
        throw UserError(
            fmt::format("{}: its lines end in carriage returns alone: write it with line feeds", file_.string()));
}

bool TextFile::next_line(std::string_view& line) {
    if (at_ == text_.size()) return false;
    const size_t end = std::min(text_.find('\n', at_), text_.size());
    const bool ended = end < text_.size();
    line = trimmed(std::string_view(text_).substr(at_, end - at_));
    at_ = end + (ended ? 1 : 0);
    ++number_;
    if (!ended && !line.empty() && line.front() != '#')
        fail("the file ends within this line: copy or write it again, or end the line");
    return true;
}

bool TextFile::next_entry(std::string_view& line) {
    while (next_line(line))
        if (!line.empty() && line.front() != '#') return true;
    return false;
}

std::string TextFile::where() const { return fmt::format("{}:{}", file_.string(), number_); }

void TextFile::fail(const std::string& problem) const { throw UserError(fmt::format("{}: {}", where(), problem)); }

double TextFile::to_double(std::string_view token, const char* what) const {
    double value = 0;
    if (parse(token, value) != std::errc())
        fail(fmt::format("{} is '{}', which is no number: correct the line", what, token));
    if (!std::isfinite(value)) fail(fmt::format("{} is '{}', which is not finite: correct the line", what, token));
    return value;
}

float TextFile::to_float(std::string_view token, const char* what) const {
    float value = 0;
    if (parse(token, value) != std::errc()) value = static_cast<float>(to_double(token, what));  // 1e-50, say, is 0
    if (!std::isfinite(value)) fail(fmt::format("{} is '{}', which is not finite: correct the line", what, token));
    return value;
}

uint64_t TextFile::to_unsigned(std::string_view token, const char* what) const {
    uint64_t value = 0;
    if (parse(token, value) != std::errc())
        fail(fmt::format("{} is '{}', which is no whole number: correct the line", what, token));
    return value;
}

int64_t TextFile::to_signed(std::string_view token, const char* what) const {
    int64_t value = 0;
    if (parse(token, value) != std::errc())
        fail(fmt::format("{} is '{}', which is no whole number: correct the line", what, token));
    return value;
}

std::vector<std::string_view> split_tokens(std::string_view line) {
    std::vector<std::string_view> tokens;
    for (size_t at = line.find_first_not_of(blanks); at != std::string_view::npos;) {
        const size_t end = std::min(line.find_first_of(blanks, at), line.size());
        tokens.push_back(line.substr(at, end - at));
        at = line.find_first_not_of(blanks, end);
    }
    return tokens;
}

}  // namespace radiafit
