#version 450 core
// One level of the gather inside view maps: a map of side SOURCE_SIDE becomes one of side TARGET_SIDE = ceil(/4), every
// texel the sum of a block of 4 x 4. MAXIMUM as in tile_texels.frag.
#ifndef SOURCE_SIDE
#define SOURCE_SIDE 8
#define TARGET_SIDE 2
#endif
uniform sampler2DArray source;
layout(location = 0) out vec4 total;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 map = at / TARGET_SIDE;
    ivec2 first = (at - map * TARGET_SIDE) * 4;
    total = vec4(0.0);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            ivec2 cell = first + ivec2(i, j);
            bool inside = max(cell.x, cell.y) < SOURCE_SIDE;
            vec4 x = texelFetch(source, ivec3(map * SOURCE_SIDE + (inside ? cell : first), 0), 0);
            x = inside ? x : vec4(0.0);
#ifdef MAXIMUM
            total = vec4(x.r > total.r ? x.r : total.r, x.g > total.g ? x.g : total.g, x.b > total.b ? x.b : total.b, 0.0);
#else
            total += x;
#endif
        }
}
