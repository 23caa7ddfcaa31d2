#version 450 core
// variants: WEIGHTED=-,1
// h_k(v) = sum_j w_j h_k[j] in this image, for every vertex. WEIGHTED: alpha is the root of what its samples weigh.
#include "gather/maps.glsl"
uniform MAPS view_maps;
uniform sampler2DArray footprints;  // layers: weights, first texel
uniform int term;
layout(location = 0) out vec4 value;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 w = texelFetch(footprints, ivec3(at, 0), 0);
    ivec3 base = ivec3(at * VIEW_SIDE + ivec2(texelFetch(footprints, ivec3(at, 1), 0).xy), term);
    value = vec4(w.x * load(texelFetch(view_maps, base, 0)) + w.y * load(texelFetch(view_maps, base + ivec3(1, 0, 0), 0)) +
                     w.z * load(texelFetch(view_maps, base + ivec3(0, 1, 0), 0)) +
                     w.w * load(texelFetch(view_maps, base + ivec3(1, 1, 0), 0)), 0.0);
#ifdef WEIGHTED
    value.a = w.x + w.y + w.z + w.w;
#endif
}
