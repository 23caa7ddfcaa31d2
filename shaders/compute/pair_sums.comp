#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8
// What each camera's view of a vertex adds to its view map, over the tiles of its ring.
#include "compute/vertices.glsl"
uniform samplerBuffer group_sums;  // [group][corner][term]
layout(std430) writeonly buffer PairSums { vec4 pair_sums[]; };  // [pair][term]
void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    for (uint p = v.pair + lane(); p < v.pair_end; p += uint(LANES)) {
        uint first = at_table(TABLE_PAIR_FIRST, p), last = at_table(TABLE_PAIR_FIRST, p + 1u);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            vec3 sum = vec3(0.0);
            for (uint i = first; i < last; ++i)
                sum += element_at(group_sums, at_table(TABLE_PAIR_GROUPS, i) * uint(TERMS) + k);
            pair_sums[p * uint(TERMS) + k] = vec4(sum, 0.0);
        }
    }
}
