#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 DIAGONAL=-,1
// From sums over samples to E_t of a vertex's problems and its gradient, penalties included; DIAGONAL: also to the fresh
// preconditioner.
#include "compute/vertices.glsl"
#include "compute/penalty.glsl"
uniform samplerBuffer maps;  // x
uniform samplerBuffer smoothed;
uniform samplerBuffer pair_sums;  // [pair][term]
uniform samplerBuffer tile_sums;  // [tile][corner][TILE_SUMS]
uniform usamplerBuffer pairs;
layout(std430) buffer Gradient { vec4 gradient[]; };  // of surface maps: comes as sums
#ifdef DIAGONAL
uniform samplerBuffer pair_squares;
layout(std430) buffer Fresh { vec4 fresh[]; };  // likewise
#endif
uniform int first_term;
uniform int last_term;  // terms outside [first, last) stay as they are

// The sums over the pairs whose look-ups have a weight on a texel of the view map.
void sum_over_view_texel(Vertex v, uint local, uint k, out vec3 slope, out vec3 squares) {
    slope = squares = vec3(0.0);
    const uvec2 place = uvec2(local % uint(VIEW_SIDE), local / uint(VIEW_SIDE));
    for (uint corner = 0u; corner < 4u; ++corner) {
        uvec2 back = uvec2(corner & 1u, corner >> 1);
        if (any(lessThan(place, back)) || any(greaterThan(place - back, uvec2(VIEW_SIDE - 2)))) continue;
        uint cell = vertex_index() * uint(VIEW_SIDE * VIEW_SIDE + 1) + (place.y - back.y) * uint(VIEW_SIDE) + place.x - back.x;
        uint last = at_table(TABLE_CELL_FIRST, cell + 1u);
        for (uint i = at_table(TABLE_CELL_FIRST, cell); i < last; ++i) {
            uint p = v.pair + at_table(TABLE_CELL_PAIRS, i);
            float weight = uintBitsToFloat(texelFetch(pairs, 2 * int(p))[corner]);
            slope += weight * element_at(pair_sums, p * uint(TERMS) + k);
#ifdef DIAGONAL
            squares += weight * weight * element_at(pair_squares, p * uint(TERMS) + k);
#endif
        }
    }
}

void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    uint texels = site_count(v), surface = (v.view_first - v.first) / uint(TERMS);
    float inverse_density = OF_THIS_VERTEX(OF_DENSITY).x;
    vec3 error = vec3(0.0), largest = vec3(0.0);
    for (uint map = v.ring + lane(); map < v.ring_end; map += uint(LANES))
        error += 0.5 * inverse_density * element_at(tile_sums, of_map(map, MAP_CORNER) * uint(TILE_SUMS));
    for (uint i = lane(); i < texels; i += uint(LANES)) {
        Site site = site_at(v, i);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            uint at = element_of(site, k);
            vec3 slope, squares;
            if (i < surface) {
                slope = gradient[at].xyz;
#ifdef DIAGONAL
                squares = fresh[at].xyz;
#endif
            } else {
                sum_over_view_texel(v, site.local, k, slope, squares);
            }
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
