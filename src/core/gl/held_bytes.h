#pragma once
#include <cstdint>

namespace radiafit {

/// Bytes of all textures and buffers of the current context, by the sizes and formats that OpenGL itself reports of
/// each: a witness for Context::allocated_bytes(), which the program counts as it makes them. What the driver adds to
/// them, such as padding, it does not report. Looks at names up to 65535, which drivers hand out from 1 on.
uint64_t held_bytes();

}  // namespace radiafit
