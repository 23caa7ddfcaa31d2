#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 ALL=12 LOSS=*
// At p along d: what an image adds to the sums over a tile's samples that the steps of its three vertices are made from.
#include "compute/tile_pixels.glsl"
uniform samplerBuffer direction;    // d
uniform samplerBuffer pair_slopes;  // [vertex][term]: what the camera sees of d's view map
layout(std430) buffer TileSums { vec4 tile_sums[]; };  // [tile][corner][TILE_SUMS]
void main() {
    if (group_index() >= uint(drawn_count)) return;
    uint tile = this_tile();
    vec3 corners[3], h[3 * TERMS], dh[3 * TERMS], sums[ALL];
    float root[3];
    uint map[3];
    for (int c = 0; c < 3; ++c) {
        uint vertex = word_of_tile(tile, TILE_VERTEX + c);
        map[c] = word_of_tile(tile, TILE_MAP + c);
        corners[c] = corner_of(vertex);
        root[c] = texelFetch(pair_values, int(vertex) * TERMS).w;
        for (int k = 0; k < TERMS; ++k) {
            h[c * TERMS + k] = element_at(pair_values, vertex * uint(TERMS) + uint(k));
            dh[c * TERMS + k] = element_at(pair_slopes, vertex * uint(TERMS) + uint(k));
        }
    }
    if (root[0] == 0.0 && root[1] == 0.0 && root[2] == 0.0) return;
    for (int i = 0; i < ALL; ++i) sums[i] = vec3(0.0);
    ivec3 frame = tile_frame(int(tile), SIDE);
    for (uint local = lane(); local < texel_count; local += uint(LANES)) {
        ivec2 cell = cell_of(local);
        vec3 weights = cell_barycentric(cell), colour;
        if (!take(frame, cell, weights, corners, colour)) continue;
        for (int c = 0; c < 3; ++c) {
            if (root[c] == 0.0) continue;
            vec3 r = -(root[c] * weights[c] * target_scale) * colour, a = vec3(0.0), b = vec3(0.0);
            for (int k = 0; k < TERMS; ++k) {
                uint at = map[c] + local * uint(TERMS) + uint(k);
                vec3 g = element_at(maps, at), dg = element_at(direction, at);
                r += lfm_value(g, h[c * TERMS + k]);
                a += lfm_slope(g, h[c * TERMS + k], dg, dh[c * TERMS + k]);
                b += lfm_bend(dg, dh[c * TERMS + k]);
            }
            sums[4 * c] += LOSS_WEIGHTED(r * r, a * a);
            sums[4 * c + 1] += LOSS_WEIGHTED(r * r, a * a + 2.0 * r * b);
            sums[4 * c + 2] += LOSS_WEIGHTED(r * r, a * b);
            sums[4 * c + 3] += LOSS_WEIGHTED(r * r, b * b);
        }
    }
    share(sums);
    for (uint i = lane(); i < uint(ALL); i += uint(LANES)) tile_sums[tile * 3u * uint(TILE_SUMS) + i].xyz += shared_sum(i);
}
