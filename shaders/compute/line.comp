#version 450 core
// variants: LANES=32 NUMBER_COUNT=10 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 WIDE=-,1 LOSS=*
// At p along d: the sums over a vertex's samples that a step is made from (Eq. 13), and the penalties' curvature.
#include "compute/vertices.glsl"
#include "model/loss.glsl"
#include "model/lfm.glsl"
#include "compute/samples.glsl"
#include "compute/look_up.glsl"
#include "compute/penalty.glsl"
uniform samplerBuffer point;
uniform samplerBuffer direction;
uniform int penalized;

void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    vec3 sum[4] = vec3[4](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    for (uint p = v.pair + lane(); p < v.pair_end; p += uint(LANES)) {
        Pair pair = pair_at(p);
        vec3 h[TERMS], dh[TERMS];
        for (uint k = 0u; k < uint(TERMS); ++k) {
            h[k] = look_up(point, v.view_first, pair, k);
            dh[k] = look_up(direction, v.view_first, pair, k);
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
                vec3 a = vec3(0.0), b = vec3(0.0);
                for (uint k = 0u; k < uint(TERMS); ++k) {
                    vec3 g = element_at(point, at + k), dg = element_at(direction, at + k);
                    r += lfm_value(g, h[k]);
                    a += lfm_slope(g, h[k], dg, dh[k]);
                    b += lfm_bend(dg, dh[k]);
                }
                sum[0] += LOSS_WEIGHTED(r * r, a * a);
                sum[1] += LOSS_WEIGHTED(r * r, a * a + 2.0 * r * b);
                sum[2] += LOSS_WEIGHTED(r * r, a * b);
                sum[3] += LOSS_WEIGHTED(r * r, b * b);
            }
        }
    }
    vec3 penalty = vec3(0.0);
    uint texels = penalized != 0 ? site_count(v) : 0u;
    for (uint i = lane(); i < texels; i += uint(LANES)) {
        Site site = site_at(v, i);
        for (uint k = 0u; k < uint(TERMS); ++k) {
            uint at = element_of(site, k);
            vec3 once = laplacian(direction, site, k);
            penalty += site.smoothness * once * once +
                       bound_curvature(element_at(point, at), element_at(direction, at), k);
        }
    }
    float inverse_density = OF_THIS_VERTEX(OF_DENSITY).x;
    for (uint i = 0u; i < 4u; ++i) {
        vec3 whole = group_sum(inverse_density * sum[i] + (i < 2u ? penalty : vec3(0.0)));
        if (lane() == 0u) OF_THIS_VERTEX(OF_LINE + int(i)) = vec4(whole, 0.0);
    }
}
