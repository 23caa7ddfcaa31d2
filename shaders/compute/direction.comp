#version 450 core
// variants: LANES=32 NUMBER_COUNT=10 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 DIAGONAL=-,1 WIDE=-,1 LOSS=*
// At the trial: E_t of a vertex's problems and its gradient (Eq. 12), penalties included; DIAGONAL: also the fresh
// preconditioner. Residuals are formed twice, once for each order of the samples, so that no two invocations add into
// one number.
#include "compute/vertices.glsl"
#include "model/loss.glsl"
#include "model/lfm.glsl"
#include "compute/samples.glsl"
#include "compute/look_up.glsl"
#include "compute/penalty.glsl"
layout(std430) readonly buffer Trial { vec4 trial[]; };
layout(std430) buffer Gradient { vec4 gradient[]; };
#ifdef DIAGONAL
layout(std430) buffer Fresh { vec4 fresh[]; };
#endif
layout(std430) buffer PairSums { vec4 pair_sums[]; };  // [pair][term][3]: h_k; sum of r g_k; of g_k^2
layout(std430) buffer Smoothed { vec4 smoothed[]; };   // L x
uniform int first_term;
uniform int last_term;  // terms outside [first, last) stay as they are

#define OF_PAIR(pair, k, what) pair_sums[((pair) * uint(TERMS) + uint(k)) * 3u + uint(what)]
#define TRIAL_AT(i) trial[i].xyz
#define SMOOTHED_AT(i) smoothed[i].xyz

// Every camera's view of the vertex: E, and what the view map's gradient is made of.
vec3 sum_over_pairs(Vertex v) {
    vec3 error = vec3(0.0);
    for (uint p = v.pair + lane(); p < v.pair_end; p += uint(LANES)) {
        Pair pair = pair_at(p);
        vec3 h[TERMS], sum[TERMS];
#ifdef DIAGONAL
        vec3 squares[TERMS];
#endif
        for (uint k = 0u; k < uint(TERMS); ++k) {
            h[k] = LOOK_UP(trial, v.view_first, pair, k);
            OF_PAIR(p, k, 0) = vec4(h[k], pair.root);
            sum[k] = vec3(0.0);
#ifdef DIAGONAL
            squares[k] = vec3(0.0);
#endif
        }
        for (uint map = v.ring; map < v.ring_end; ++map) {
            uint group = half_at_table(TABLE_GROUPS_OF_IMAGES, of_map(map, MAP_IMAGE_GROUP) + pair.image);
            if (group == NONE) continue;
            group += of_map(map, MAP_GROUP);
            uint last = at_table(TABLE_GROUP_FIRST, group + 1u);
            uint map_first = of_map(map, MAP_FIRST), weights = of_map(map, MAP_WEIGHT);
            for (uint s = at_table(TABLE_GROUP_FIRST, group); s < last; ++s) {
                WORD word = samples_by_image[s];
                uint local = place_of(word), at = map_first + local * uint(TERMS);
                float weight = uintBitsToFloat(at_table(TABLE_TARGET_WEIGHTS, weights + local));
                vec3 r = -(pair.root * weight) * colour_of(word);
                vec3 g[TERMS];
                for (uint k = 0u; k < uint(TERMS); ++k) {
                    g[k] = trial[at + k].xyz;
                    r += lfm_value(g[k], h[k]);
                }
                error += LOSS_VALUE(r * r);
                vec3 weighted = LOSS_WEIGHTED(r * r, r);
                for (uint k = 0u; k < uint(TERMS); ++k) {
                    sum[k] += lfm_gradient_view(weighted, g[k]);
#ifdef DIAGONAL
                    squares[k] += LOSS_WEIGHTED(r * r, g[k] * g[k]);
#endif
                }
            }
        }
        for (uint k = 0u; k < uint(TERMS); ++k) {
            OF_PAIR(p, k, 1) = vec4(sum[k], 0.0);
#ifdef DIAGONAL
            OF_PAIR(p, k, 2) = vec4(squares[k], 0.0);
#endif
        }
    }
    return error;
}

// The sums over a texel's samples.
void sum_over_texel(Vertex v, uint map, uint local, out vec3 slope[TERMS], out vec3 squares[TERMS]) {
    vec3 g[TERMS];
    for (uint k = 0u; k < uint(TERMS); ++k) {
        g[k] = trial[of_map(map, MAP_FIRST) + local * uint(TERMS) + k].xyz;
        slope[k] = squares[k] = vec3(0.0);
    }
    float weight = target_weight(map, local);
    uint texel = of_map(map, MAP_TEXEL) + local, pairs_of_groups = of_map(map, MAP_GROUP_PAIR);
    uint last = at_table(TABLE_TEXEL_FIRST, texel + 1u);
    for (uint s = at_table(TABLE_TEXEL_FIRST, texel); s < last; ++s) {
        WORD word = samples_by_texel[s];
        uint p = v.pair + half_at_table(TABLE_PAIRS_OF_GROUPS, pairs_of_groups + place_of(word));
        vec4 first = OF_PAIR(p, 0, 0);
        vec3 h[TERMS];
        vec3 r = -(first.w * weight) * colour_of(word);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            h[k] = k == 0u ? first.xyz : OF_PAIR(p, k, 0).xyz;
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
            float weight = uintBitsToFloat(pairs[2u * p][corner]);
            for (uint k = 0u; k < uint(TERMS); ++k) {
                slope[k] += weight * OF_PAIR(p, k, 1).xyz;
#ifdef DIAGONAL
                squares[k] += weight * weight * OF_PAIR(p, k, 2).xyz;
#endif
            }
        }
    }
}

void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    vec3 error = sum_over_pairs(v);
    uint texels = site_count(v);
    for (uint i = lane(); i < texels; i += uint(LANES)) {
        Site site = site_at(v, i);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            vec3 once;
            LAPLACIAN(once, site, k, TRIAL_AT)
            smoothed[element_of(site, k)] = vec4(once, 0.0);
        }
    }
    memoryBarrierBuffer();
    barrier();

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
            vec3 x = trial[at].xyz, once = smoothed[at].xyz, twice;
            LAPLACIAN(twice, site, k, SMOOTHED_AT)
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
    error = group_sum(0.5 * inverse_density * error + penalty);
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
