#version 450 core
// variants: BATCH=1,2 TERMS=1,2 QUARTIC=-,1
// variants: BATCH=2 TERMS=2 QUARTIC=-,1 COUNT=-,1 WEIGHTED=1
// The sums along d of corners [FIRST, FIRST + CORNERS) of tiles for a batch of images, blended over batches: a tile's
// fragment projects each of its texels, takes its pixels and adds its terms (Eq. 13). QUARTIC: with the two further sums.
// COUNT: sum of L t and samples.
#include "model/prelude.glsl"
#define element vec3
#include "model/loss.glsl"
#include "model/lfm.glsl"
#include "combine/cameras.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#include "combine/tile_at_one.glsl"
#include "combine/take_item.glsl"
#ifndef FIRST
#define FIRST 0
#define CORNERS 2
#endif
uniform MAPS surface_maps;
uniform MAPS surface_direction;
uniform sampler2DArray view_values;
uniform sampler2DArray view_slopes;
uniform sampler2DArray vertex_frames;  // layer 0: position
const int columns = COLUMNS;
#ifdef COUNT
layout(location = 0) out vec4 total[CORNERS];
#else
layout(location = 0) out vec4 gauss_newton[CORNERS];
layout(location = CORNERS) out vec4 curvature[CORNERS];
#ifdef QUARTIC
layout(location = 2 * CORNERS) out vec4 third[CORNERS];
layout(location = 3 * CORNERS) out vec4 fourth[CORNERS];
#endif
#endif

ivec2 problem_of(uint vertex) { return ivec2(int(vertex) % columns, int(vertex) / columns); }

vec3 values[BATCH * CORNERS * TERMS], slopes[BATCH * CORNERS * TERMS];
vec3 projected[3 * BATCH];
#ifdef WEIGHTED
float roots[BATCH * CORNERS];  // of the samples' weights
#endif

#define LOOK_UP(image) look_up(image, of_tile)
void look_up(int image, uvec4 of_tile) {
    for (int corner = 0; corner < 3; ++corner)
        projected[3 * image + corner] =
            project(image, texelFetch(vertex_frames, ivec3(problem_of(of_tile[corner]), 0), 0).xyz);
#ifndef COUNT
    for (int c = 0; c < CORNERS; ++c)
        for (int k = 0; k < TERMS; ++k) {
            ivec3 at = ivec3(problem_of(of_tile[FIRST + c]), image * TERMS + k);
            values[(image * CORNERS + c) * TERMS + k] = texelFetch(view_values, at, 0).rgb;
            slopes[(image * CORNERS + c) * TERMS + k] = texelFetch(view_slopes, at, 0).rgb;
#ifdef WEIGHTED
            roots[image * CORNERS + c] = texelFetch(view_values, at, 0).a;
#endif
        }
#endif
}

struct Sums {
    vec4 aa[CORNERS];  // COUNT: of L t, and samples
    vec3 arb[CORNERS], ab[CORNERS], bb[CORNERS];
};

#define ADD(image) add(image, place, weights, g, dg, sums)
void add(int image, ivec2 place, vec3 weights, vec3 g[CORNERS * TERMS], vec3 dg[CORNERS * TERMS], inout Sums sums) {
    uvec2 colour;
    bool present = take_item(image, projected[3 * image], projected[3 * image + 1], projected[3 * image + 2], weights,
                             place, colour);
    vec3 target = target_of(image, colour);
    for (int c = 0; c < CORNERS; ++c) {
        vec3 t = weights[FIRST + c] * target;
#ifdef COUNT
        sums.aa[c] += present ? vec4(t, 1.0) : vec4(0.0);
#else
#ifdef WEIGHTED
        t *= roots[image * CORNERS + c];
#endif
        vec3 r = -t, a = vec3(0.0), b = vec3(0.0);
        for (int k = 0; k < TERMS; ++k) {
            vec3 h = values[(image * CORNERS + c) * TERMS + k], dh = slopes[(image * CORNERS + c) * TERMS + k];
            r += lfm_value(g[c * TERMS + k], h);
            a += lfm_slope(g[c * TERMS + k], h, dg[c * TERMS + k], dh);
            b += lfm_bend(dg[c * TERMS + k], dh);
        }
        // Where no pixel is taken all three are nothing, and so are their products.
        r = present ? r : vec3(0.0);
        a = present ? a : vec3(0.0);
        b = present ? b : vec3(0.0);
        sums.aa[c].rgb += LOSS_WEIGHTED(r * r, a * a);
        sums.arb[c] += LOSS_WEIGHTED(r * r, a * a + 2.0 * r * b);
#ifdef QUARTIC
        sums.ab[c] += LOSS_WEIGHTED(r * r, a * b);
        sums.bb[c] += LOSS_WEIGHTED(r * r, b * b);
#endif
#endif
    }
}

void main() {
    uvec4 of_tile = texelFetch(tile_vertices, ivec2(gl_FragCoord.xy), 0);
    ivec3 frame = tile_frame(int(of_tile.w), SIDE);
    FOR_EACH_IMAGE(LOOK_UP)
    Sums sums;
    for (int c = 0; c < CORNERS; ++c) {
        sums.aa[c] = vec4(0.0);
        sums.arb[c] = sums.ab[c] = sums.bb[c] = vec3(0.0);
    }
    int rows = rows_to_visit();
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < SIDE - j; ++i) {
            ivec2 place = frame.xy + frame.z * ivec2(i, j);
            vec3 weights = cell_barycentric(ivec2(i, j));
            vec3 g[CORNERS * TERMS], dg[CORNERS * TERMS];
#ifndef COUNT
            for (int c = 0; c < CORNERS * TERMS; ++c) {
                g[c] = load(texelFetch(surface_maps, ivec3(place, FIRST * TERMS + c), 0));
                dg[c] = load(texelFetch(surface_direction, ivec3(place, FIRST * TERMS + c), 0));
            }
#endif
            FOR_EACH_IMAGE(ADD)
        }
    for (int c = 0; c < CORNERS; ++c) {
#ifdef COUNT
        total[c] = sums.aa[c];
#else
        gauss_newton[c] = vec4(sums.aa[c].rgb, 0.0);
        curvature[c] = vec4(sums.arb[c], 0.0);
#ifdef QUARTIC
        third[c] = vec4(sums.ab[c], 0.0);
        fourth[c] = vec4(sums.bb[c], 0.0);
#endif
#endif
    }
}
