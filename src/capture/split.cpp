#include "capture/split.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/error.h"
#include "base/wording.h"
#include "capture/text_file.h"

namespace radiafit {

std::vector<uint8_t> choose_held_out(const std::vector<std::string>& names, const std::string& rule) {
    std::vector<uint8_t> held_out(names.size(), 0);
    if (rule == "none") return held_out;
    if (rule.starts_with("every:")) {
        size_t step = 0;
        const char* end = rule.data() + rule.size();
        const auto parsed = std::from_chars(rule.data() + 6, end, step);
        if (parsed.ec != std::errc() || parsed.ptr != end || step < 2)
            throw UserError(fmt::format("{} {}: N is to be a whole number from 2 on, as in every:8 (or none)",
                                        option_name("holdout"), rule));
        for (size_t i = 0; i < names.size(); i += step) held_out[i] = 1;
    } else {
        TextFile text(rule, fmt::format("list of held-out images ({} takes every:N, none or such a file)",
                                        option_name("holdout")));
        bool any = false;
        for (std::string_view line; text.next_entry(line); any = true) {
            const auto at = std::find(names.begin(), names.end(), line);
            if (at == names.end())
                text.fail(
                    fmt::format("no image is named '{}': write one name per line, as the images have them", line));
            held_out[size_t(at - names.begin())] = 1;
        }
        if (!any)
            throw UserError(
                fmt::format("{}: names no image: write one per line, or {} none", rule, option_name("holdout")));
    }
    if (std::find(held_out.begin(), held_out.end(), 0) == held_out.end())
        throw UserError(fmt::format("{} {}: holds out all {} images and leaves none to fit: hold out fewer",
                                    option_name("holdout"), rule, names.size()));
    return held_out;
}

}  // namespace radiafit
