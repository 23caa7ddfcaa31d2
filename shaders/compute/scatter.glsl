// One radiance sample, and what it adds to the sums of its triangle's three vertices: to E and the gradient's sums at x,
// DIAGONAL also to those of diag(J'J); ALONG d to the sums that steps are made from, QUARTIC all four of them; TARGET_ONLY
// its target, and one to its tile's number of samples.
#include "compute/tiles.glsl"
#include "model/loss.glsl"
#include "model/lfm.glsl"
uniform samplerBuffer maps;         // x; or p, along d
uniform samplerBuffer direction;    // d
uniform samplerBuffer pair_values;  // [pair][term] h_k; alpha: root of the samples' weight, 0 where nothing is to add
uniform samplerBuffer pair_slopes;  // [pair][term]: what cameras see of d's view maps
uniform float target_sum_scale;     // of sums of targets in fixed point
#ifdef TARGET_ONLY
layout(std430) coherent buffer TileSamples { uint tile_samples[]; };
#endif

#define NO_PAIR 0xffffffffu  // of a vertex without a ring, at the rim of a part of a mesh
// weights: Lambda of the three corners times the targets' scale; pairs: of the three vertices with the image.
void scatter(uint tile, uint local, vec3 weights, vec3 colour, uvec3 pairs) {
#ifdef TARGET_ONLY
    atomicAdd(tile_samples[tile], 1u);
#endif
    for (int c = 0; c < 3; ++c) {
        uint corner = (3u * tile + uint(c)) * uint(TILE_SUMS);
#ifdef TARGET_ONLY
        ADD(corner_sums, corner, weights[c] * colour, vec3(target_sum_scale))
#else
        if (pairs[c] == NO_PAIR) continue;
        vec4 value = texelFetch(pair_values, int(pairs[c]) * TERMS);
        if (value.w == 0.0) continue;
        uint vertex = word_of_tile(tile, TILE_VERTEX + c);
        uint at = word_of_tile(tile, TILE_MAP + c) + local * uint(TERMS), of_pair = pairs[c] * uint(TERMS);
        vec3 g[TERMS], h[TERMS], r = -(value.w * weights[c]) * colour;
        for (int k = 0; k < TERMS; ++k) {
            g[k] = element_at(maps, at + uint(k));
            h[k] = k == 0 ? value.xyz : element_at(pair_values, of_pair + uint(k));
            r += lfm_value(g[k], h[k]);
        }
#ifdef ALONG
        vec3 a = vec3(0.0), b = vec3(0.0);
        for (int k = 0; k < TERMS; ++k) {
            vec3 dg = element_at(direction, at + uint(k)), dh = element_at(pair_slopes, of_pair + uint(k));
            a += lfm_slope(g[k], h[k], dg, dh);
            b += lfm_bend(dg, dh);
        }
        ADD(corner_sums, corner, LOSS_WEIGHTED(r * r, a * a), scale_of(vertex, SCALE_LINE))
        ADD(corner_sums, corner + 1u, LOSS_WEIGHTED(r * r, a * a + 2.0 * r * b), scale_of(vertex, SCALE_LINE + 1))
#ifdef QUARTIC
        ADD(corner_sums, corner + 2u, LOSS_WEIGHTED(r * r, a * b), scale_of(vertex, SCALE_LINE + 2))
        ADD(corner_sums, corner + 3u, LOSS_WEIGHTED(r * r, b * b), scale_of(vertex, SCALE_LINE + 3))
#endif
#else
        vec3 weighted = LOSS_WEIGHTED(r * r, r);
        ADD(corner_sums, corner, LOSS_VALUE(r * r), scale_of(vertex, SCALE_ERROR))
        for (int k = 0; k < TERMS; ++k) {
            ADD(element_sums, at + uint(k), lfm_gradient_surface(weighted, h[k]), scale_of(vertex, SCALE_SURFACE))
            ADD(pair_sums, of_pair + uint(k), lfm_gradient_view(weighted, g[k]), scale_of(vertex, SCALE_VIEW))
#ifdef DIAGONAL
            ADD(element_squares, at + uint(k), LOSS_WEIGHTED(r * r, h[k] * h[k]), scale_of(vertex, SCALE_SURFACE_SQUARES))
            ADD(pair_squares, of_pair + uint(k), LOSS_WEIGHTED(r * r, g[k] * g[k]), scale_of(vertex, SCALE_VIEW_SQUARES))
#endif
        }
#endif
#endif
    }
}
