#version 450 core
// One level of the gather of Section 5.2.1 inside the tiles of one corner: a tile of side SOURCE_SIDE becomes one of
// side SIDE, in a smaller texture of the same layout, with at most 16 look-ups. A target texel sums a block of 4 x 4
// cells; the last level (SIDE 1, SOURCE_SIDE <= 5) sums the whole tile.
// SQUARE: of the squares. MAXIMUM: the largest instead of the sum.
#include "distribute/tiles.glsl"
#ifndef SOURCE_SIDE
#define SOURCE_SIDE 5
#endif

layout(binding = 7) uniform sampler2DArray source;
layout(location = 8) uniform int corner;
layout(location = 3) flat in ivec3 frame;
layout(location = 4) flat in int tile_index;
layout(location = 0) out vec4 total;

#if SIDE == 1
#define BLOCK SOURCE_SIDE
#else
#define BLOCK 4
#endif

void main() {
    ivec2 first = (ivec2(gl_FragCoord.xy) - frame.xy) * frame.z * BLOCK;
    ivec2 start = tile_frame(tile_index, SOURCE_SIDE).xy;
    total = vec4(0.0);
    for (int j = 0; j < BLOCK; ++j)
        for (int i = 0; i < BLOCK; ++i) {
#if SIDE == 1
            if (i + j >= SOURCE_SIDE) continue;  // decided by the compiler
#endif
            ivec2 cell = first + ivec2(i, j);
            bool inside = cell.x + cell.y < SOURCE_SIDE;
            ivec2 place = start + frame.z * (inside ? cell : first);
            vec4 x = texelFetch(source, ivec3(place, corner), 0);
#ifdef SQUARE
            x *= x;
#endif
            x = inside ? x : vec4(0.0);  // a choice, not a product: the neighbour tile may hold NaN
#ifdef MAXIMUM
            total = vec4(x.r > total.r ? x.r : total.r, x.g > total.g ? x.g : total.g, x.b > total.b ? x.b : total.b, 0.0);
#else
            total += x;
#endif
        }
}
