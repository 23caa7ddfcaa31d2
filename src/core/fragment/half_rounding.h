#pragma once
#include <string>
#include <vector>

#include "fragment/fragment_options.h"
#include "gl/shader_text.h"

namespace radiafit {

/// How values between two 16-bit floats are rounded, in words such as "to nearest, ties to even".
struct HalfRounding {
    std::string of;  ///< "packing" (packHalf2x16), "storage" (Storage::fp16: packed, or where that is not to nearest,
                     ///< rounded in the shader), "render target" (fp16_truncate), "blended sum" (Sums::fp16)
    std::string values;      ///< of normal ones
    std::string subnormals;  ///< below 6.1e-5, where halves lie as far apart as at it: likewise, or "become 0"
};
/// Measured on the current context's device, for each of the four: OpenGL leaves it to drivers.
std::vector<HalfRounding> measure_half_rounding();

/// What shaders/gather/maps.glsl is told of a storage on the current context's device, measured once for each renderer.
Defines storage_defines(Storage storage);

}  // namespace radiafit
