#pragma once
#include <functional>
#include <string>

namespace radiafit {

/// The GLSL text of a texel-local model (docs/texel-models.md) with what it lacks of `shape_slope` and `shape_bend`
/// made from its basis() and behind it: the same statements over numbers that carry their derivatives, in place of
/// operators calls of functions of these (forward mode; Griewank and Walther 2008, chapters 3 and 13). The text itself
/// if it lacks nothing or has no shape. shaped: its SHAPED_COUNT, as C++ reads it; at least 1. read: what a file that
/// it includes holds. Throws UserError, "file:line: ...": it is not in the dialect.
std::string with_derivatives(const std::string& file, const std::string& text, int shaped,
                             const std::function<std::string(const std::string& file)>& read);

}  // namespace radiafit
