#version 450 core
// variants: MAXIMUM=-,1 TURNS=-,3,16
// A further level of the gather inside tiles: up to 16 of the BANDS bands of ROWS rows (see gather/tile_texels.frag) become
// one. MAXIMUM: the largest instead of the sum. TURNS: so many entries for every fragment, whether it has as many or not.
#ifndef BANDS
#define BANDS 5
#endif
#ifndef ROWS
#define ROWS 64
#endif
uniform sampler2DArray source;
layout(location = 0) out vec4 total;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    int first = at.y / ROWS * 16;
    int bands = min(16, BANDS - first);
#ifdef TURNS
    const int turns = TURNS;
#else
    int turns = bands;
#endif
    at.y %= ROWS;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < turns; ++i) {
#ifdef TURNS
        vec4 x = texelFetch(source, ivec3(at.x, at.y + (i < bands ? first + i : first) * ROWS, 0), 0);
        x = i < bands ? x : vec4(0.0);
#else
        vec4 x = texelFetch(source, ivec3(at.x, at.y + (first + i) * ROWS, 0), 0);
#endif
#ifdef MAXIMUM
        sum = vec4(x.r > sum.r ? x.r : sum.r, x.g > sum.g ? x.g : sum.g, x.b > sum.b ? x.b : sum.b, 0.0);
#else
        sum += x;
#endif
    }
    total = sum;
}
