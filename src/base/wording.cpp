#include "base/wording.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>

namespace radiafit {
namespace {

std::atomic<bool> by_flag = false;

}  // namespace

void name_options_by_flag() { by_flag = true; }

std::string option_name(std::string_view name) {
    if (by_flag) return fmt::format("--{}", name);
    std::string member(name);
    std::replace(member.begin(), member.end(), '-', '_');
    return fmt::format("'{}'", member);
}

std::string at_command_line(std::string_view typed, std::string_view otherwise) {
    return std::string(by_flag ? typed : otherwise);
}

}  // namespace radiafit
