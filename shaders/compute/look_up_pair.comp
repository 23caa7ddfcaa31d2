#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8
// What a camera sees of a vertex's view map, an invocation for each; of vertices whose problems have ended nothing, with a
// weight of 0.
#include "compute/vertices.glsl"
#include "compute/look_up.glsl"
uniform int pair_count;
void main() {
    uint p = group_index() * uint(LANES) + lane();
    if (p >= uint(pair_count)) return;
    uvec4 rest = rest_of(p);
    if (is_active(rest.z))
        look_up(p, at_table(TABLE_VERTICES, rest.z * VERTEX_WORDS + 1u), rest);
    else
        pair_values[p * uint(TERMS)] = vec4(0.0);
}
