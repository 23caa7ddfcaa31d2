#version 450 core
// variants: LANES=32 NUMBER_COUNT=10 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 DIAGONAL=-,1 WIDE=-,1 LOSS=*
// The first half of E_t and its gradient at the trial (Eq. 12): what each camera's view of a vertex adds up over its samples,
// and L x. shaders/compute/gradient.comp is the other half. Residuals are formed in both, once for each order of the samples,
// so that no two invocations add into one number.
#include "compute/vertices.glsl"
#include "model/loss.glsl"
#include "model/lfm.glsl"
#include "compute/samples.glsl"
#include "compute/look_up.glsl"
#include "compute/penalty.glsl"
uniform samplerBuffer trial;
layout(std430) writeonly buffer PairSums { vec4 pair_sums[]; };  // [pair][term][3]: h_k; sum of r g_k; of g_k^2
layout(std430) writeonly buffer Smoothed { vec4 smoothed[]; };   // L x
#define OF_PAIR(pair, k, what) pair_sums[((pair) * uint(TERMS) + uint(k)) * 3u + uint(what)]

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
            h[k] = look_up(trial, v.view_first, pair, k);
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
                WORD word = sample_at(samples_by_image, s);
                uint local = place_of(word), at = map_first + local * uint(TERMS);
                float weight = uintBitsToFloat(at_table(TABLE_TARGET_WEIGHTS, weights + local));
                vec3 r = -(pair.root * weight) * colour_of(word);
                vec3 g[TERMS];
                for (uint k = 0u; k < uint(TERMS); ++k) {
                    g[k] = element_at(trial, at + k);
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

void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    vec3 error = group_sum(sum_over_pairs(v));
    if (lane() == 0u) OF_THIS_VERTEX(OF_RESIDUALS) = vec4(error, 0.0);
    uint texels = site_count(v);
    for (uint i = lane(); i < texels; i += uint(LANES)) {
        Site site = site_at(v, i);
        for (uint k = 0u; k < uint(TERMS); ++k) smoothed[element_of(site, k)] = vec4(laplacian(trial, site, k), 0.0);
    }
}
