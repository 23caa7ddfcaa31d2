#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 SUMS=sums_by_pair
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 SUMS=sums_scattered ACCUMULATE=1,3
// From tiles' sums along d to those of a vertex's problems, penalties included.
#include "compute/vertices.glsl"
#include "compute/penalty.glsl"
uniform samplerBuffer maps;  // p
uniform samplerBuffer direction;
#include "compute/SUMS.glsl"
uniform int penalized;
void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    vec3 penalty = vec3(0.0);
    uint texels = penalized != 0 ? site_count(v) : 0u;
    for (uint i = lane(); i < texels; i += uint(LANES)) {
        Site site = site_at(v, i);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            uint at = element_of(site, k);
            vec3 once = laplacian(direction, site, k);
            penalty += site.smoothness * once * once +
                       bound_curvature(element_at(maps, at), element_at(direction, at), k);
        }
    }
    float inverse_density = OF_THIS_VERTEX(OF_DENSITY).x;
    for (uint i = 0u; i < 4u; ++i) {
        vec3 sum = i < 2u ? penalty : vec3(0.0);
        for (uint map = v.ring + lane(); map < v.ring_end; map += uint(LANES))
            sum += inverse_density * sum_of_corner(of_map(map, MAP_CORNER), int(i));
        sum = group_sum(sum);
        if (lane() == 0u) OF_THIS_VERTEX(OF_LINE + int(i)) = vec4(sum, 0.0);
    }
}
