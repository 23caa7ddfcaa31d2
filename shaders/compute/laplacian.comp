#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8
// L x of Eq. 9.
#include "compute/vertices.glsl"
#include "compute/penalty.glsl"
uniform samplerBuffer maps;
layout(std430) writeonly buffer Smoothed { vec4 smoothed[]; };
void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    uint texels = site_count(v);
    for (uint i = lane(); i < texels; i += uint(LANES)) {
        Site site = site_at(v, i);
        for (uint k = 0u; k < uint(TERMS); ++k) smoothed[element_of(site, k)] = vec4(laplacian(maps, site, k), 0.0);
    }
}
