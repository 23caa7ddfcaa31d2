#version 450 core
// One level of the gather of Section 5.2.1 inside the tiles of one corner: tiles of side SOURCE_SIDE become tiles of
// side SIDE, in a smaller texture of the same layout, with at most 16 look-ups. A target texel sums a block of 4 x 4
// cells; the last level (SIDE 1, SOURCE_SIDE <= 5) sums the whole tile, and leaves zero where no tile was drawn.
// SQUARE: of the squares. MAXIMUM: the largest instead of the sum.
#include "distribute/tiles.glsl"
#ifndef SOURCE_SIDE
#define SOURCE_SIDE 5
#endif

layout(binding = 7) uniform sampler2DArray source;
layout(binding = 8) uniform sampler2D drawn;  // 1 for tiles that the mesh's latest passes drew
layout(location = 8) uniform int corner;
layout(location = 0) out vec4 total;

#if SIDE == 1
#define BLOCK SOURCE_SIDE
#else
#define BLOCK 4
#endif

void main() {
    ivec3 at = tile_at(ivec2(gl_FragCoord.xy));
    ivec2 first = at.xy * BLOCK;
    ivec3 frame = tile_frame(at.z, SOURCE_SIDE);
    vec4 sum = vec4(0.0);
    for (int j = 0; j < BLOCK; ++j)
        for (int i = 0; i < BLOCK; ++i) {
#if SIDE == 1
            if (i + j >= SOURCE_SIDE) continue;  // decided by the compiler
#endif
            ivec2 cell = first + ivec2(i, j);
            bool inside = cell.x + cell.y < SOURCE_SIDE;
            vec4 x = texelFetch(source, ivec3(frame.xy + frame.z * (inside ? cell : first), corner), 0);
#ifdef SQUARE
            x *= x;
#endif
            x = inside ? x : vec4(0.0);  // a choice, not a product: the neighbour tile may hold NaN
#ifdef MAXIMUM
            sum = vec4(x.r > sum.r ? x.r : sum.r, x.g > sum.g ? x.g : sum.g, x.b > sum.b ? x.b : sum.b, 0.0);
#else
            sum += x;
#endif
        }
#if SIDE == 1
    total = texelFetch(drawn, ivec2(gl_FragCoord.xy), 0).r > 0.0 ? sum : vec4(0.0);
#else
    total = sum;
#endif
}
