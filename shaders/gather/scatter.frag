#version 450 core
// dE/dh_k[j] += w_j sum_ring r g_k. DIAGONAL: w_j^2 sum_ring g_k^2.
uniform sampler2D ring_sums;
layout(location = 0) flat in vec4 weights;
layout(location = 1) flat in ivec4 place;
layout(location = 0) out vec4 gradient;
void main() {
    ivec2 which = ivec2(gl_FragCoord.xy) - place.xy;
    vec2 row = which.y == 0 ? weights.xy : weights.zw;
    float w = which.x == 0 ? row.x : row.y;
#ifdef DIAGONAL
    w *= w;
#endif
    gradient = vec4(w * texelFetch(ring_sums, place.zw, 0).rgb, 0.0);
}
