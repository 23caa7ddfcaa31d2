#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1 ALL=6 DIAGONAL=-,1 LOSS=*
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=3 ALL=12 DIAGONAL=-,1
// What an image adds to the gradient of the surface maps of a tile (and DIAGONAL to diag(J'J)), to the view maps of its
// vertices, as one sum for each, and to E. ALL: 3 x TERMS + 3.
#include "compute/tile_pixels.glsl"
layout(std430) buffer Gradient { vec4 gradient[]; };
layout(std430) writeonly buffer GroupSums { vec4 group_sums[]; };  // [tile][corner][term]; alpha: `turn`
#ifdef DIAGONAL
layout(std430) buffer Fresh { vec4 fresh[]; };
layout(std430) writeonly buffer GroupSquares { vec4 group_squares[]; };
#endif
layout(std430) buffer TileSums { vec4 tile_sums[]; };  // [tile][corner][TILE_SUMS]
uniform float turn;  // a number of this image alone: sums with another alpha are of another image
void main() {
    if (group_index() >= uint(drawn_count)) return;
    uint tile = this_tile();
    vec3 corners[3], h[3 * TERMS], products[ALL];
    vec3 squares[ALL];
    float root[3];
    uint map[3];
    for (int c = 0; c < 3; ++c) {
        uint vertex = word_of_tile(tile, TILE_VERTEX + c);
        map[c] = word_of_tile(tile, TILE_MAP + c);
        corners[c] = corner_of(vertex);
        root[c] = texelFetch(pair_values, int(vertex) * TERMS).w;
        for (int k = 0; k < TERMS; ++k) h[c * TERMS + k] = element_at(pair_values, vertex * uint(TERMS) + uint(k));
    }
    if (root[0] == 0.0 && root[1] == 0.0 && root[2] == 0.0) return;
    for (int i = 0; i < ALL; ++i) products[i] = squares[i] = vec3(0.0);
    ivec3 frame = tile_frame(int(tile), SIDE);
    for (uint local = lane(); local < texel_count; local += uint(LANES)) {
        ivec2 cell = cell_of(local);
        vec3 weights = cell_barycentric(cell), colour;
        if (!take(frame, cell, weights, corners, colour)) continue;
        for (int c = 0; c < 3; ++c) {
            if (root[c] == 0.0) continue;
            vec3 g[TERMS], r = -(root[c] * weights[c] * target_scale) * colour;
            uint at = map[c] + local * uint(TERMS);
            for (int k = 0; k < TERMS; ++k) {
                g[k] = element_at(maps, at + uint(k));
                r += lfm_value(g[k], h[c * TERMS + k]);
            }
            vec3 weighted = LOSS_WEIGHTED(r * r, r);
            products[3 * TERMS + c] += LOSS_VALUE(r * r);
            for (int k = 0; k < TERMS; ++k) {
                gradient[at + uint(k)].xyz += lfm_gradient_surface(weighted, h[c * TERMS + k]);
                products[c * TERMS + k] += lfm_gradient_view(weighted, g[k]);
#ifdef DIAGONAL
                fresh[at + uint(k)].xyz += LOSS_WEIGHTED(r * r, h[c * TERMS + k] * h[c * TERMS + k]);
                squares[c * TERMS + k] += LOSS_WEIGHTED(r * r, g[k] * g[k]);
#endif
            }
        }
    }
    uint first = tile * 3u * uint(TERMS);
    share(products);
    for (uint i = lane(); i < 3u * uint(TERMS); i += uint(LANES)) group_sums[first + i] = vec4(shared_sum(i), turn);
    if (lane() < 3u)
        tile_sums[(3u * tile + lane()) * uint(TILE_SUMS)].xyz += shared_sum(3u * uint(TERMS) + lane());
#ifdef DIAGONAL
    share(squares);
    for (uint i = lane(); i < 3u * uint(TERMS); i += uint(LANES)) group_squares[first + i] = vec4(shared_sum(i), turn);
#endif
}
