#version 450 core
// variants: LANES=32 NUMBER_COUNT=10 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 DIAGONAL=-,1 WIDE=-,1 LOSS=*
// After shaders/compute/pairs.comp: E_t of a vertex's problems and its gradient, penalties included; DIAGONAL: also the fresh
// preconditioner.
#include "compute/vertices.glsl"
#include "model/loss.glsl"
#include "model/lfm.glsl"
#include "compute/samples.glsl"
#include "compute/look_up.glsl"
#include "compute/penalty.glsl"
uniform samplerBuffer trial;
uniform samplerBuffer pair_sums;
uniform samplerBuffer smoothed;
layout(std430) writeonly buffer Gradient { vec4 gradient[]; };
#ifdef DIAGONAL
layout(std430) buffer Fresh { vec4 fresh[]; };
#endif
uniform int first_term;
uniform int last_term;  // terms outside [first, last) stay as they are
vec4 of_pair(uint pair, uint k, int what) { return texelFetch(pair_sums, (int(pair) * TERMS + int(k)) * 3 + what); }

// The sums over a texel's samples.
void sum_over_texel(Vertex v, uint map, uint local, out vec3 slope[TERMS], out vec3 squares[TERMS]) {
    vec3 g[TERMS];
    for (uint k = 0u; k < uint(TERMS); ++k) {
        g[k] = element_at(trial, of_map(map, MAP_FIRST) + local * uint(TERMS) + k);
        slope[k] = squares[k] = vec3(0.0);
    }
    float weight = target_weight(map, local);
    uint texel = of_map(map, MAP_TEXEL) + local, pairs_of_groups = of_map(map, MAP_GROUP_PAIR);
    uint last = at_table(TABLE_TEXEL_FIRST, texel + 1u);
    for (uint s = at_table(TABLE_TEXEL_FIRST, texel); s < last; ++s) {
        WORD word = sample_at(samples_by_texel, s);
        uint p = v.pair + half_at_table(TABLE_PAIRS_OF_GROUPS, pairs_of_groups + place_of(word));
        vec4 first = of_pair(p, 0u, 0);
        vec3 h[TERMS];
        vec3 r = -(first.w * weight) * colour_of(word);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            h[k] = k == 0u ? first.xyz : of_pair(p, k, 0).xyz;
            r += lfm_value(g[k], h[k]);
        }
        vec3 weighted = LOSS_WEIGHTED(r * r, r);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            slope[k] += lfm_gradient_surface(weighted, h[k]);
#ifdef DIAGONAL
            squares[k] += LOSS_WEIGHTED(r * r, h[k] * h[k]);
#endif
        }
    }
}

// The sums over the pairs whose look-ups have a weight on a texel of the view map.
void sum_over_view_texel(Vertex v, uint local, out vec3 slope[TERMS], out vec3 squares[TERMS]) {
    for (uint k = 0u; k < uint(TERMS); ++k) slope[k] = squares[k] = vec3(0.0);
    const uvec2 place = uvec2(local % uint(VIEW_SIDE), local / uint(VIEW_SIDE));
    for (uint corner = 0u; corner < 4u; ++corner) {
        uvec2 step = uvec2(corner & 1u, corner >> 1);
        if (any(lessThan(place, step)) || any(greaterThan(place - step, uvec2(VIEW_SIDE - 2)))) continue;
        uint cell = vertex_index() * uint(VIEW_SIDE * VIEW_SIDE + 1) + (place.y - step.y) * uint(VIEW_SIDE) + place.x - step.x;
        uint last = at_table(TABLE_CELL_FIRST, cell + 1u);
        for (uint i = at_table(TABLE_CELL_FIRST, cell); i < last; ++i) {
            uint p = v.pair + at_table(TABLE_CELL_PAIRS, i);
            float weight = uintBitsToFloat(texelFetch(pairs, 2 * int(p))[corner]);
            for (uint k = 0u; k < uint(TERMS); ++k) {
                slope[k] += weight * of_pair(p, k, 1).xyz;
#ifdef DIAGONAL
                squares[k] += weight * weight * of_pair(p, k, 2).xyz;
#endif
            }
        }
    }
}

void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    uint texels = site_count(v);
    uint surface = (v.view_first - v.first) / uint(TERMS);
    float inverse_density = OF_THIS_VERTEX(OF_DENSITY).x;
    vec3 penalty = vec3(0.0), largest = vec3(0.0);
    for (uint i = lane(); i < texels; i += uint(LANES)) {
        vec3 slope[TERMS], squares[TERMS];
        Site site = site_at(v, i);
        if (i < surface)
            sum_over_texel(v, v.ring + (at_table(TABLE_SITES, v.site + i) >> 16), site.local, slope, squares);
        else
            sum_over_view_texel(v, site.local, slope, squares);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            uint at = element_of(site, k);
            vec3 x = element_at(trial, at), once = element_at(smoothed, at), twice = laplacian(smoothed, site, k);
            penalty += 0.5 * site.smoothness * once * once + bound_error(x, k);
            slope[k] = slope[k] * inverse_density + site.smoothness * twice + bound_slope(x, k);
            bool fitted = int(k) >= first_term && int(k) < last_term;
            gradient[at] = vec4(fitted ? slope[k] : vec3(0.0), 0.0);
#ifdef DIAGONAL
            vec3 entry = squares[k] * inverse_density + 20.0 * site.smoothness;
            largest = max(largest, entry);
            fresh[at] = vec4(entry, 0.0);
#endif
        }
    }
    vec3 error = 0.5 * inverse_density * OF_THIS_VERTEX(OF_RESIDUALS).xyz + group_sum(penalty);
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
