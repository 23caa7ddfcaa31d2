#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 SQUARES=-,1 WIDE=-,1 LOSS=*
// What each group of a tile's samples adds to the view maps of the three vertices: sum of r g_k (Eq. 12) or, SQUARES, of
// g_k^2; and E, the sum of what residuals cost, twice.
#include "compute/samples.glsl"
layout(std430) writeonly buffer GroupSums { vec4 group_sums[]; };  // [group][corner][term]
layout(std430) buffer TileSums { vec4 tile_sums[]; };              // [tile][corner][TILE_SUMS]
void main() {
    if (group_index() >= uint(tile_count)) return;
    bvec3 running = running_corners();
    if (!any(running)) return;
    uint group_count = of_tile(TILE_GROUPS), first_group = of_tile(TILE_GROUP), weights_first = of_tile(TILE_WEIGHT);
    uint block = of_tile(TILE_GROUP_BLOCK);
    uint map[3] = uint[3](of_tile(TILE_MAP), of_tile(TILE_MAP + 1), of_tile(TILE_MAP + 2));
    vec3 error[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
    for (uint i = lane(); i < group_count; i += uint(LANES)) {
        uvec4 group = texelFetch(groups, int(first_group + i));
        Column column = column_of(block, i, group_count);
        vec3 h[3 * TERMS], sum[3 * TERMS];
        float root[3];
        for (int c = 0; c < 3; ++c)
            for (int k = 0; k < TERMS; ++k) {
                vec4 value = texelFetch(pair_values, int(group[1 + c]) * TERMS + k);
                h[c * TERMS + k] = value.xyz;
                root[c] = value.w;
                sum[c * TERMS + k] = vec3(0.0);
            }
        for (uint s = 0u; s < group.x; ++s) {
            WORD word = sample_at(samples_by_group, column.first + s * column.stride);
            uint local = place_of(word);
            vec3 weights = texelFetch(target_weights, int(weights_first + local)).xyz, colour = colour_of(word);
            for (int c = 0; c < 3; ++c) {
                vec3 g[TERMS], r = -(root[c] * weights[c]) * colour;
                for (int k = 0; k < TERMS; ++k) {
                    g[k] = element_at(maps, map[c] + local * uint(TERMS) + uint(k));
                    r += lfm_value(g[k], h[c * TERMS + k]);
                }
#ifdef SQUARES
                for (int k = 0; k < TERMS; ++k) sum[c * TERMS + k] += LOSS_WEIGHTED(r * r, g[k] * g[k]);
#else
                error[c] += LOSS_VALUE(r * r);
                vec3 weighted = LOSS_WEIGHTED(r * r, r);
                for (int k = 0; k < TERMS; ++k) sum[c * TERMS + k] += lfm_gradient_view(weighted, g[k]);
#endif
            }
        }
        for (uint k = 0u; k < 3u * uint(TERMS); ++k)
            group_sums[(first_group + i) * 3u * uint(TERMS) + k] = vec4(sum[k], 0.0);
    }
#ifndef SQUARES
    for (uint c = 0u; c < 3u; ++c) {
        vec3 whole = group_sum(error[c]);
        if (lane() == 0u) tile_sums[(group_index() * 3u + c) * uint(TILE_SUMS)] = vec4(whole, 0.0);
    }
#endif
}
