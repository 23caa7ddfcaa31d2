#version 450 core
// The texture item buffer: which SLS texel a pixel's centre sees.
#include "distribute/tiles.glsl"

layout(location = 5) uniform int layout_width;

layout(location = 0) in vec2 barycentric;
layout(location = 1) flat in ivec3 frame;
layout(location = 0) out uint item;  // row * layout_width + column

void main() {
    ivec2 cell = clamp(ivec2(barycentric * float(SIDE)), ivec2(0), ivec2(SIDE - 1));
    // Beyond the diagonal by rounding only: one step back along the longer coordinate.
    if (cell.x + cell.y >= SIDE) cell -= cell.x > cell.y ? ivec2(1, 0) : ivec2(0, 1);
    ivec2 place = frame.xy + frame.z * cell;
    item = uint(place.y * layout_width + place.x);
}
