#include "base/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/log.h"
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

void append_utf8(std::string& text, uint32_t code) {
    const auto add = [&](uint32_t byte) { text += static_cast<char>(byte); };
    const auto add_last = [&](int bits) { add(0x80 | ((code >> bits) & 0x3f)); };
    if (code < 0x80) return add(code);
    if (code < 0x800) return add(0xc0 | (code >> 6)), add_last(0);
    if (code < 0x10000) return add(0xe0 | (code >> 12)), add_last(6), add_last(0);
    add(0xf0 | (code >> 18)), add_last(12), add_last(6), add_last(0);
}

/// UTF-8 from UTF-16 (RFC 2781), without its mark. high: the place of a unit's high byte, 0 or 1.
std::string from_utf16(std::string_view bytes, size_t high, const std::filesystem::path& file) {
    const auto fail = [&] {
        throw UserError(fmt::format("{}: damaged UTF-16 text: save it again, as UTF-8", file.string()));
    };
    if (bytes.size() % 2 != 0) fail();
    const auto unit = [&](size_t at) {
        return uint32_t(uint8_t(bytes[at + high])) << 8 | uint32_t(uint8_t(bytes[at + 1 - high]));
    };
    std::string text;
    for (size_t at = 2; at < bytes.size(); at += 2) {
        uint32_t code = unit(at);
        if (code >= 0xd800 && code < 0xe000) {  // one of a pair, which is a character beyond 16 bits
            const uint32_t second = at + 2 < bytes.size() ? unit(at + 2) : 0;
            if (code >= 0xdc00 || second < 0xdc00 || second >= 0xe000) fail();
            code = 0x10000 + ((code - 0xd800) << 10) + (second - 0xdc00);
            at += 2;
        }
        append_utf8(text, code);
    }
    return text;
}

/// Whether zero bytes are what UTF-16 makes of Latin letters: of each pair of the first bytes, one and always the same.
bool looks_like_utf16(std::string_view bytes) {
    size_t zeros[2] = {0, 0};
    const size_t count = std::min<size_t>(bytes.size() & ~size_t(1), 64);
    for (size_t i = 0; i < count; ++i) zeros[i % 2] += bytes[i] == 0;
    return count >= 4 && (zeros[0] == 0) != (zeros[1] == 0) && 4 * (zeros[0] + zeros[1]) > count;
}

}  // namespace

std::string plain_text(std::string text, const std::filesystem::path& file) {
    if (text.starts_with("\xff\xfe"))
        text = from_utf16(text, 1, file);
    else if (text.starts_with("\xfe\xff"))
        text = from_utf16(text, 0, file);
    if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
    if (text.find('\0') != std::string::npos)
        throw UserError(looks_like_utf16(text)
                            ? fmt::format("{}: UTF-16 text without a byte order mark: save it as UTF-8", file.string())
                            : fmt::format("{}: holds zero bytes, so it is no text or a damaged one: write it again",
                                          file.string()));
    if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
    return text;
}

TextFile::TextFile(const std::filesystem::path& file, const std::string& what)
    : TextFile(file, read_file(file, what), 0) {}

TextFile::TextFile(std::filesystem::path file, std::string text, size_t lines_before)
    : file_(std::move(file)), text_(plain_text(std::move(text), file_)), number_(lines_before) {}

bool TextFile::next_line(std::string_view& line) {
    if (at_ == text_.size()) {
        if (!ended_)
            log_warning(
                fmt::format("{}: no line break ends this last line: taken as whole; if the file was cut, write "
                            "it again",
                            where()));
        ended_ = true;
        return false;
    }
    const size_t end = std::min(text_.find('\n', at_), text_.size());
    const bool broken = end < text_.size();
    line = trimmed(std::string_view(text_).substr(at_, end - at_));
    at_ = end + (broken ? 1 : 0);
    ++number_;
    ended_ = broken || line.empty() || line.front() == '#';
    return true;
}

bool TextFile::next_entry(std::string_view& line) {
    while (next_line(line))
        if (!line.empty() && line.front() != '#') return true;
    return false;
}

std::string TextFile::where() const { return fmt::format("{}:{}", file_.string(), number_); }

void TextFile::fail(const std::string& problem) const {
    throw UserError(
        ended_ ? fmt::format("{}: {}", where(), problem)
               : fmt::format("{}: the file ends within this line: copy or write it again ({})", where(), problem));
}

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
