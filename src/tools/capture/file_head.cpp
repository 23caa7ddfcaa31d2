#include "capture/file_head.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "base/error.h"

namespace radiafit::tools {

void FileHead::fail(const std::string& why) const {
    throw UserError(
        fmt::format("{}: truncated or corrupt ({}); copy it again from where it was made", file_.string(), why));
}

std::string_view FileHead::line() {
    const size_t end = rest_.find('\n');
    if (end == std::string_view::npos) fail("it ends within its header");
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
    return line;
}

std::string_view FileHead::word(const char* what) {
    constexpr std::string_view blanks = " \t\r\n";
    rest_.remove_prefix(std::min(rest_.size(), rest_.find_first_not_of(blanks)));
    const size_t end = rest_.find_first_of(blanks);
    if (end == std::string_view::npos) fail(fmt::format("it ends before its {}", what));
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return word;
}

double FileHead::number(const char* what) {
    const std::string_view text = word(what);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        fail(fmt::format("its {} is no number", what));
    return value;
}

int FileHead::whole(const char* what, int least, int most) {
    const double value = number(what);
    if (!(value >= least && value <= most) || value != std::floor(value))
        fail(fmt::format("its {} is {:g}, no whole number from {} to {}", what, value, least, most));
    return int(value);
}

void FileHead::end_line() {
    const size_t end = rest_.find_first_not_of(" \t\r");
    if (end == std::string_view::npos || rest_[end] != '\n') fail("its header does not end with a line");
    rest_.remove_prefix(end + 1);
}

std::string_view FileHead::bytes(uint64_t count) {
    if (count > rest_.size()) fail(fmt::format("{} bytes are missing at its end", count - rest_.size()));
    const std::string_view out = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return out;
}

}  // namespace radiafit::tools
