#include "capture/text_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "base/error.h"

namespace radiafit {
namespace {
constexpr std::string_view blanks = " \t\r";

std::string_view trimmed(std::string_view line) {
    const size_t first = line.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return line.substr(first, line.find_last_not_of(blanks) - first + 1);
}
}  // namespace

TextFile::TextFile(const std::filesystem::path& file, const std::string& what) : file_(file), stream_(file) {
    if (!stream_ || !std::filesystem::is_regular_file(file))
        throw UserError(fmt::format("{}: cannot read this {}: check the path", file.string(), what));
}

bool TextFile::next_line(std::string_view& line) {
    if (!std::getline(stream_, line_)) return false;
    ++number_;
    line = trimmed(line_);
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
    const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (code != std::errc() || end != token.data() + token.size())
        fail(fmt::format("{} is '{}', which is no number: mend the line", what, token));
    if (!std::isfinite(value)) fail(fmt::format("{} is '{}', which is not finite: mend the line", what, token));
    return value;
}

uint64_t TextFile::to_unsigned(std::string_view token, const char* what) const {
    uint64_t value = 0;
    const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (code != std::errc() || end != token.data() + token.size())
        fail(fmt::format("{} is '{}', which is no whole number: mend the line", what, token));
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
