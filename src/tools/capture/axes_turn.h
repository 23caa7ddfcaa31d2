#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "base/linear.h"

/// Turns of axes, mirrored ones too, as options have them: "x,z,-y", the old axes that the new x, y and z are.
namespace radiafit::tools {

/// Exactly three parts between commas; blanks around them are dropped.
std::optional<std::array<std::string_view, 3>> three_parts(std::string_view text);

/// new = turn * old. None unless each axis is named once.
std::optional<Mat3d> parse_axes_turn(std::string_view text);

/// The text that parse_axes_turn() makes such a matrix of.
std::string axes_turn_text(const Mat3d& turn);

}  // namespace radiafit::tools
