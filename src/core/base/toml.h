#pragma once
#include <string>
#include <string_view>

namespace radiafit {

/// A TOML text's values as JSON, tables as objects, days as texts such as "2026-11-27". Throws std::logic_error with
/// line and reason: for texts that are built into a program. Configs are read by base/config.h.
std::string json_of_toml(std::string_view text);

}  // namespace radiafit
