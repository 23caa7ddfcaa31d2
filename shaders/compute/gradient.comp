#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 DIAGONAL=-,1 SUMS=sums_by_pair,sums_in_place
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 DIAGONAL=-,1 SUMS=sums_scattered ACCUMULATE=1,3
// From sums over samples to E_t of a vertex's problems and its gradient, penalties included; DIAGONAL: also to the fresh
// preconditioner.
#include "compute/vertices.glsl"
#include "compute/penalty.glsl"
uniform samplerBuffer maps;  // x
uniform samplerBuffer smoothed;
layout(std430) buffer Gradient { vec4 gradient[]; };  // may come as sums
#ifdef DIAGONAL
layout(std430) buffer Fresh { vec4 fresh[]; };  // may come as sums
#endif
#define OF_ELEMENTS
#include "compute/SUMS.glsl"
uniform int first_term;
uniform int last_term;  // terms outside [first, last) stay as they are

void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    uint texels = site_count(v), surface = (v.view_first - v.first) / uint(TERMS);
    float inverse_density = OF_THIS_VERTEX(OF_DENSITY).x;
    vec3 error = vec3(0.0), largest = vec3(0.0);
    for (uint map = v.ring + lane(); map < v.ring_end; map += uint(LANES))
        error += 0.5 * inverse_density * sum_of_corner(of_map(map, MAP_CORNER), 0);
    for (uint i = lane(); i < texels; i += uint(LANES)) {
        Site site = site_at(v, i);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            uint at = element_of(site, k);
            vec3 slope, squares;
            sums_of(v, site, k, i >= surface, slope, squares);
            vec3 x = element_at(maps, at), once = element_at(smoothed, at), twice = laplacian(smoothed, site, k);
            error += 0.5 * site.smoothness * once * once + bound_error(x, k);
            slope = slope * inverse_density + site.smoothness * twice + bound_slope(x, k);
            bool fitted = int(k) >= first_term && int(k) < last_term;
            gradient[at] = vec4(fitted ? slope : vec3(0.0), 0.0);
#ifdef DIAGONAL
            vec3 entry = squares * inverse_density + 20.0 * site.smoothness;
            largest = max(largest, entry);
            fresh[at] = vec4(entry, 0.0);
#endif
        }
    }
    error = group_sum(error);
    if (lane() == 0u) OF_THIS_VERTEX(OF_ERROR) = vec4(error, 0.0);
#ifdef DIAGONAL
    largest = group_max(largest);
    for (uint i = lane(); i < texels; i += uint(LANES)) {
        Site site = site_at(v, i);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            uint at = element_of(site, k);
            fresh[at] = vec4(preconditioner(fresh[at].xyz, largest, vec3(1.0e-30)), 0.0);
        }
    }
#endif
}
