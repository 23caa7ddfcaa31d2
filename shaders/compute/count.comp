#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1 WIDE=-,1
// Sums over a tile's samples of the targets L t of its three corners.
#include "compute/samples.glsl"
layout(std430) writeonly buffer TileSums { vec4 tile_sums[]; };  // [tile][corner][TILE_SUMS]
void main() {
    if (group_index() >= uint(tile_count)) return;
    uint texel_count = of_tile(TILE_TEXELS), first_texel = of_tile(TILE_TEXEL);
    uint block = of_tile(TILE_TEXEL_BLOCK), weights_first = of_tile(TILE_WEIGHT);
    vec3 sum[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
    for (uint i = lane(); i < texel_count; i += uint(LANES)) {
        uint texel = at_table(TABLE_TEXELS, first_texel + i), count = texel >> 16;
        Column column = column_of(block, i, texel_count);
        vec3 weights = texelFetch(target_weights, int(weights_first + (texel & 0xffffu))).xyz, colours = vec3(0.0);
        for (uint s = 0u; s < count; ++s)
            colours += colour_of(sample_at(samples_by_texel, column.first + s * column.stride));
        for (int c = 0; c < 3; ++c) sum[c] += weights[c] * colours;
    }
    for (uint c = 0u; c < 3u; ++c) {
        vec3 whole = group_sum(sum[c]);
        if (lane() == 0u) tile_sums[(group_index() * 3u + c) * uint(TILE_SUMS)] = vec4(whole, 0.0);
    }
}
