#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 SQUARES=-,1
// What an image adds to the gradient of a vertex's view map, from the tiles of its ring; an invocation is a vertex. Or to
// diag(J'J): SQUARES.
#include "compute/vertices.glsl"
uniform samplerBuffer group_sums;  // [tile][corner][term]; alpha: of which image
uniform usamplerBuffer pairs;      // [vertex][2], as compute/look_up.glsl has them
uniform float turn;
layout(std430) buffer Sums { vec4 sums[]; };  // the gradient's
void main() {
    uint vertex = group_index() * uint(LANES) + lane();
    if (vertex >= uint(vertex_count) || !is_active(vertex)) return;
    vec4 weights = uintBitsToFloat(texelFetch(pairs, 2 * int(vertex)));
    uvec4 rest = texelFetch(pairs, 2 * int(vertex) + 1);
#ifdef SQUARES
    vec4 factors = weights * weights;
#else
    vec4 factors = weights;
#endif
    uint row = vertex * VERTEX_WORDS, first_map = at_table(TABLE_VERTICES, row + 2u), end_map = at_table(TABLE_VERTICES, row + 3u);
    uint first = at_table(TABLE_VERTICES, row + 1u) + rest.x * uint(TERMS);
    for (uint k = 0u; k < uint(TERMS); ++k) {
        vec3 sum = vec3(0.0);
        for (uint map = first_map; map < end_map; ++map) {
            vec4 of_tile = texelFetch(group_sums, int(of_map(map, MAP_CORNER)) * TERMS + int(k));
            sum += of_tile.w == turn ? of_tile.xyz : vec3(0.0);
        }
        for (uint corner = 0u; corner < 4u; ++corner) {
            uint at = first + (corner >> 1) * uint(VIEW_SIDE * TERMS) + (corner & 1u) * uint(TERMS) + k;
            sums[at].xyz += factors[corner] * sum;
        }
    }
}
