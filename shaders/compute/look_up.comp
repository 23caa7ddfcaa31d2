#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8
// What every camera sees of a vertex's view map: h_k, with the root of the samples' weight in it.
#include "compute/vertices.glsl"
uniform usamplerBuffer pairs;  // [pair][2]: weights of texels (x0, y0), (x0 + 1, y0), (x0, y0 + 1), (x0 + 1, y0 + 1), the root in them; the first texel, the root
uniform samplerBuffer maps;
layout(std430) writeonly buffer PairValues { vec4 pair_values[]; };
void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    for (uint p = v.pair + lane(); p < v.pair_end; p += uint(LANES)) {
        vec4 weights = uintBitsToFloat(texelFetch(pairs, 2 * int(p)));
        uvec4 rest = texelFetch(pairs, 2 * int(p) + 1);
        const uint row = uint(VIEW_SIDE * TERMS);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            uint at = v.view_first + rest.x * uint(TERMS) + k;
            vec3 h = weights.x * element_at(maps, at) + weights.y * element_at(maps, at + uint(TERMS)) +
                     weights.z * element_at(maps, at + row) + weights.w * element_at(maps, at + row + uint(TERMS));
            pair_values[p * uint(TERMS) + k] = vec4(h, uintBitsToFloat(rest.y));
        }
    }
}
