#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8
// What every camera sees of a vertex's view map.
#include "compute/vertices.glsl"
#include "compute/look_up.glsl"
void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    for (uint p = v.pair + lane(); p < v.pair_end; p += uint(LANES)) look_up(p, v.view_first, rest_of(p));
}
