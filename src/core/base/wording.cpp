#include "base/wording.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <utility>

namespace radiafit {
namespace {

std::atomic<bool> by_flag = false;
std::map<std::string, std::string, std::less<>> names;  // set before anything reads them

std::string own_name(std::string_view name) {
    const auto found = names.find(name);
    return found == names.end() ? std::string(name) : found->second;
}

}  // namespace

void name_options_by_flag(std::map<std::string, std::string, std::less<>> otherwise) {
    names = std::move(otherwise);
    by_flag = true;
}

std::string option_name(std::string_view name) {
    if (by_flag) return "--" + own_name(name);
    std::string member(name);
    std::replace(member.begin(), member.end(), '-', '_');
    return fmt::format("'{}'", member);
}

std::string at_command_line(std::string_view typed, std::string_view otherwise) {
    return by_flag ? own_name(typed) : std::string(otherwise);
}

}  // namespace radiafit
