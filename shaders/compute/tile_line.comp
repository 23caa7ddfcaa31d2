#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 WIDE=-,1 LOSS=*
// At p along d: the sums over a tile's samples that the steps of its three vertices are made from (Eq. 13).
#include "compute/samples.glsl"
uniform samplerBuffer direction;    // d
uniform samplerBuffer pair_slopes;  // [pair][term]: what cameras see of d's view maps
layout(std430) writeonly buffer TileSums { vec4 tile_sums[]; };  // [tile][corner][TILE_SUMS]
void main() {
    if (group_index() >= uint(tile_count)) return;
    bvec3 running = running_corners();
    if (!any(running)) return;
    uint group_count = of_tile(TILE_GROUPS), first_group = of_tile(TILE_GROUP), weights_first = of_tile(TILE_WEIGHT);
    uint block = of_tile(TILE_GROUP_BLOCK);
    uint map[3] = uint[3](of_tile(TILE_MAP), of_tile(TILE_MAP + 1), of_tile(TILE_MAP + 2));
    vec3 sum[12];
    for (int i = 0; i < 12; ++i) sum[i] = vec3(0.0);
    for (uint i = lane(); i < group_count; i += uint(LANES)) {
        uvec4 group = texelFetch(groups, int(first_group + i));
        Column column = column_of(block, i, group_count);
        vec3 h[3 * TERMS], dh[3 * TERMS];
        float root[3];
        for (int c = 0; c < 3; ++c)
            for (int k = 0; k < TERMS; ++k) {
                int at = int(group[1 + c]) * TERMS + k;
                vec4 value = texelFetch(pair_values, at);
                h[c * TERMS + k] = value.xyz;
                dh[c * TERMS + k] = texelFetch(pair_slopes, at).xyz;
                root[c] = value.w;
            }
        for (uint s = 0u; s < group.x; ++s) {
            WORD word = sample_at(samples_by_group, column.first + s * column.stride);
            uint local = place_of(word);
            vec3 weights = texelFetch(target_weights, int(weights_first + local)).xyz, colour = colour_of(word);
            for (int c = 0; c < 3; ++c) {
                vec3 r = -(root[c] * weights[c]) * colour, a = vec3(0.0), b = vec3(0.0);
                for (int k = 0; k < TERMS; ++k) {
                    uint at = map[c] + local * uint(TERMS) + uint(k);
                    vec3 g = element_at(maps, at), dg = element_at(direction, at);
                    r += lfm_value(g, h[c * TERMS + k]);
                    a += lfm_slope(g, h[c * TERMS + k], dg, dh[c * TERMS + k]);
                    b += lfm_bend(dg, dh[c * TERMS + k]);
                }
                sum[4 * c] += LOSS_WEIGHTED(r * r, a * a);
                sum[4 * c + 1] += LOSS_WEIGHTED(r * r, a * a + 2.0 * r * b);
                sum[4 * c + 2] += LOSS_WEIGHTED(r * r, a * b);
                sum[4 * c + 3] += LOSS_WEIGHTED(r * r, b * b);
            }
        }
    }
    for (uint i = 0u; i < 12u; ++i) {
        vec3 whole = group_sum(sum[i]);
        if (lane() == 0u) tile_sums[(group_index() * 3u + i / 4u) * uint(TILE_SUMS) + i % 4u] = vec4(whole, 0.0);
    }
}
