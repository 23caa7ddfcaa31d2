#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 ACCUMULATE=1,3 DIAGONAL=-,1
// What samples left with a camera's view of a vertex goes on to the texels of its look-up; an invocation is a view. The sums
// that it takes are zero again.
#define WITH_ELEMENTS
#define WITH_PAIRS
#include "compute/accumulate.glsl"
#include "compute/vertices.glsl"
uniform usamplerBuffer pairs;  // as in compute/look_up.comp
uniform int pair_count;
void main() {
    uint p = group_index() * uint(LANES) + lane();
    if (p >= uint(pair_count)) return;
    vec4 weights = uintBitsToFloat(texelFetch(pairs, 2 * int(p)));
    uvec4 rest = texelFetch(pairs, 2 * int(p) + 1);
    uint vertex = rest.z, first = at_table(TABLE_VERTICES, vertex * VERTEX_WORDS + 1u) + rest.x * uint(TERMS);
    for (uint k = 0u; k < uint(TERMS); ++k) {
        uint of_pair = p * uint(TERMS) + k;
        vec3 sum = SUM(pair_sums, of_pair, scale_of(vertex, SCALE_VIEW));
        CLEAR(pair_sums, of_pair)
#ifdef DIAGONAL
        vec3 squares = SUM(pair_squares, of_pair, scale_of(vertex, SCALE_VIEW_SQUARES));
        CLEAR(pair_squares, of_pair)
#endif
        for (uint corner = 0u; corner < 4u; ++corner) {
            uint at = first + (corner >> 1) * uint(VIEW_SIDE * TERMS) + (corner & 1u) * uint(TERMS) + k;
            float weight = weights[corner];
            if (weight == 0.0) continue;
            ADD(element_sums, at, weight * sum, scale_of(vertex, SCALE_VIEW))
#ifdef DIAGONAL
            ADD(element_squares, at, weight * weight * squares, scale_of(vertex, SCALE_VIEW_SQUARES))
#endif
        }
    }
}
