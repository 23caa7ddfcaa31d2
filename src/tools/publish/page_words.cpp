#include "publish/page_words.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "base/error.h"
#include "base/range.h"

namespace radiafit::tools {
namespace {

constexpr std::array<std::pair<std::string_view, double>, 7> units = {
    {{"um", 1e-6}, {"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}, {"km", 1e3}, {"in", 0.0254}, {"ft", 0.3048}}};
constexpr Range<double> length_numbers{1e-9, 1e9};

}  // namespace

double parse_length(std::string_view name, std::string_view text) {
    const size_t end = text.find_last_not_of("abcdefghijklmnopqrstuvwxyz");
    if (end != std::string_view::npos) {
        const std::string_view unit = text.substr(end + 1);
        const std::string_view number = text.substr(0, text.find_last_not_of(' ', end) + 1);
        for (const auto& [known, metres] : units)
            if (unit == known) return metres * parse_number(name, number, length_numbers);
    }
    throw UserError(fmt::format(
        "{} = '{}': give a number above 0 and its unit, um, mm, cm, m, km, in or ft, such as 1mm", name, text));
}

}  // namespace radiafit::tools
