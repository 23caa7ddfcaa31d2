#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 DIAGONAL=-,1 WIDE=-,1 LOSS=*
// The sums over the samples of each texel of a tile that its surface maps' gradient is made of: of r h_k (Eq. 12); DIAGONAL:
// also of h_k^2.
#include "compute/samples.glsl"
layout(std430) writeonly buffer Gradient { vec4 gradient[]; };
#ifdef DIAGONAL
layout(std430) writeonly buffer Fresh { vec4 fresh[]; };
#endif
void main() {
    if (group_index() >= uint(tile_count)) return;
    bvec3 running = running_corners();
    if (!any(running)) return;
    uint texel_count = of_tile(TILE_TEXELS), first_group = of_tile(TILE_GROUP), first_texel = of_tile(TILE_TEXEL);
    uint block = of_tile(TILE_TEXEL_BLOCK), weights_first = of_tile(TILE_WEIGHT);
    uint map[3] = uint[3](of_tile(TILE_MAP), of_tile(TILE_MAP + 1), of_tile(TILE_MAP + 2));
    for (uint i = lane(); i < texel_count; i += uint(LANES)) {
        uint texel = at_table(TABLE_TEXELS, first_texel + i), local = texel & 0xffffu, count = texel >> 16;
        Column column = column_of(block, i, texel_count);
        vec3 weights = texelFetch(target_weights, int(weights_first + local)).xyz;
        vec3 g[3 * TERMS], slope[3 * TERMS];
#ifdef DIAGONAL
        vec3 squares[3 * TERMS];
#endif
        for (int c = 0; c < 3; ++c)
            for (int k = 0; k < TERMS; ++k) {
                g[c * TERMS + k] = element_at(maps, map[c] + local * uint(TERMS) + uint(k));
                slope[c * TERMS + k] = vec3(0.0);
#ifdef DIAGONAL
                squares[c * TERMS + k] = vec3(0.0);
#endif
            }
        for (uint s = 0u; s < count; ++s) {
            WORD word = sample_at(samples_by_texel, column.first + s * column.stride);
            uvec4 group = texelFetch(groups, int(first_group + place_of(word)));
            vec3 colour = colour_of(word);
            for (int c = 0; c < 3; ++c) {
                vec4 value = texelFetch(pair_values, int(group[1 + c]) * TERMS);
                vec3 h[TERMS], r = -(value.w * weights[c]) * colour;
                for (int k = 0; k < TERMS; ++k) {
                    h[k] = k == 0 ? value.xyz : texelFetch(pair_values, int(group[1 + c]) * TERMS + k).xyz;
                    r += lfm_value(g[c * TERMS + k], h[k]);
                }
                vec3 weighted = LOSS_WEIGHTED(r * r, r);
                for (int k = 0; k < TERMS; ++k) {
                    slope[c * TERMS + k] += lfm_gradient_surface(weighted, h[k]);
#ifdef DIAGONAL
                    squares[c * TERMS + k] += LOSS_WEIGHTED(r * r, h[k] * h[k]);
#endif
                }
            }
        }
        for (int c = 0; c < 3; ++c) {
            if (!running[c]) continue;
            for (int k = 0; k < TERMS; ++k) {
                uint at = map[c] + local * uint(TERMS) + uint(k);
                gradient[at] = vec4(slope[c * TERMS + k], 0.0);
#ifdef DIAGONAL
                fresh[at] = vec4(squares[c * TERMS + k], 0.0);
#endif
            }
        }
    }
}
