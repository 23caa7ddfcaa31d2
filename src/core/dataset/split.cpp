#include "dataset/split.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numeric>
#include <optional>

#include "base/error.h"
#include "base/rng.h"
#include "base/text_file.h"
#include "base/wording.h"
#include "geometry/direction_hull.h"

namespace radiafit {
namespace {

/// "NAME:FIRST" or "NAME:FIRST<separator>SECOND": whole numbers, and nothing else in the text.
struct Numbers {
    uint64_t first;
    std::optional<uint64_t> second;
};
std::optional<Numbers> numbers_behind(const std::string& rule, const char* name, char separator) {
    const std::string prefix = std::string(name) + ":";
    Numbers out{};
    const char *end = rule.data() + rule.size(), *at = rule.data() + prefix.size();
    const auto read = [&](uint64_t& number) {
        const auto parsed = std::from_chars(at, end, number);
        at = parsed.ptr;
        return parsed.ec == std::errc();
    };
    if (!read(out.first)) return {};
    if (at != end && *at == separator) {
        ++at;
        if (!read(out.second.emplace())) return {};
    }
    return at == end ? std::optional(out) : std::nullopt;
}

[[noreturn]] void reject(const std::string& rule, const std::string& cure) {
    throw UserError(fmt::format("{} {}: {}", option_name("holdout"), rule, cure));
}

std::vector<uint8_t> listed(const std::vector<std::string>& names, const std::string& file) {
    TextFile text(file, fmt::format("list of held-out images ({} takes every:N, every:N+K, random:N, spread:N, none or "
                                    "such a file)",
                                    option_name("holdout")));
    std::vector<uint8_t> held_out(names.size(), 0);
    bool any = false;
    for (std::string_view line; text.next_entry(line); any = true) {
        const auto at = std::find(names.begin(), names.end(), line);
        if (at == names.end())
            text.fail(fmt::format("no image is named '{}': write one name per line, as the images have them", line));
        held_out[size_t(at - names.begin())] = 1;
    }
    if (!any)
        throw UserError(
            fmt::format("{}: names no image: write one per line, or {} none", file, option_name("holdout")));
    return held_out;
}

/// What every:N, random:N and spread:N take; none if the rule is none of them.
std::optional<std::vector<size_t>> counted(size_t images, std::span<const Vec3d> directions, const std::string& rule) {
    std::vector<size_t> out;
    if (rule.starts_with("every:")) {
        const auto numbers = numbers_behind(rule, "every", '+');
        if (!numbers || numbers->first < 2 || numbers->second.value_or(0) >= numbers->first)
            reject(rule,
                   "N is to be a whole number from 2 on, as in every:8, and K below it, as in every:8+4 (or none)");
        for (size_t i = numbers->second.value_or(0); i < images; i += numbers->first) out.push_back(i);
        return out;
    }
    const bool random = rule.starts_with("random:"), spread = rule.starts_with("spread:");
    if (!random && !spread) return {};
    const auto numbers = numbers_behind(rule, random ? "random" : "spread", ':');
    if (!numbers || numbers->first < 1 || numbers->first >= images || (spread && numbers->second))
        reject(rule, fmt::format("N is to be a whole number from 1 to {}, as there are {} images{}", images - 1, images,
                                 random ? "; a seed may follow, as in random:12:5" : ""));
    if (spread) return spread_over(directions, numbers->first);
    std::vector<size_t> all(images);
    std::iota(all.begin(), all.end(), size_t(0));
    Rng rng(numbers->second.value_or(1));
    for (size_t i = 0; i < numbers->first; ++i) {
        std::swap(all[i], all[i + rng.index(uint32_t(images - i))]);
        out.push_back(all[i]);
    }
    return out;
}

}  // namespace

std::vector<uint8_t> choose_held_out(const std::vector<std::string>& names, std::span<const Vec3d> directions,
                                     const std::string& rule) {
    std::vector<uint8_t> held_out(names.size(), 0);
    if (rule == "none") return held_out;
    if (const auto chosen = counted(names.size(), directions, rule))
        for (const size_t i : *chosen) held_out[i] = 1;
    else
        held_out = listed(names, rule);
    if (std::find(held_out.begin(), held_out.end(), 0) == held_out.end())
        reject(rule, fmt::format("holds out all {} images and leaves none to fit: hold out fewer", names.size()));
    return held_out;
}

}  // namespace radiafit
