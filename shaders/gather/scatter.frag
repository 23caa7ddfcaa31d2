#version 450 core
// variants: DIAGONAL=-,1 GATHERED=-,1
// dE/dh_k[j] += w_j sum_ring r g_k. DIAGONAL: w_j^2 sum_ring g_k^2. Of the points of scatter.vert; or GATHERED, as the paper has
// it: every texel of the view maps asks whether it is one of its vertex's four.
uniform sampler2D ring_sums;
#ifdef GATHERED
#include "gather/maps.glsl"
uniform sampler2DArray footprints;  // layers: weights, first texel
#else
layout(location = 0) flat in vec4 weights;
layout(location = 1) flat in ivec4 place;  // of the footprint's first texel, and of the problem
#endif
layout(location = 0) out vec4 gradient;
void main() {
#ifdef GATHERED
    ivec2 problem = ivec2(gl_FragCoord.xy) / VIEW_SIDE;
    vec4 weights = texelFetch(footprints, ivec3(problem, 0), 0);
    ivec4 place = ivec4(problem * VIEW_SIDE + ivec2(texelFetch(footprints, ivec3(problem, 1), 0).xy), problem);
#endif
    ivec2 which = ivec2(gl_FragCoord.xy) - place.xy;
    vec2 row = which.y == 0 ? weights.xy : weights.zw;
    float w = which.x == 0 ? row.x : row.y;
#ifdef DIAGONAL
    w *= w;
#endif
    gradient = vec4(w * texelFetch(ring_sums, place.zw, 0).rgb, 0.0);
#ifdef GATHERED
    gradient = min(which.x, which.y) >= 0 && max(which.x, which.y) < 2 ? gradient : vec4(0.0);
#endif
}
