#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace radiafit {

/// The values of a TOML text, its tables as objects in the order of their names, days as texts such as "2026-11-27".
/// Throws std::logic_error with line and reason: for texts that are built into a program. Configs are read by
/// base/config.h.
nlohmann::json parse_toml(std::string_view text);

}  // namespace radiafit
