#version 450 core
// variants: BATCH=1,2 TERMS=1,2 COLOUR=8,16 DIAGONAL=-,1
// variants: BATCH=2 TERMS=2 COLOUR=8 DIAGONAL=-,1 WEIGHTED=1
// Corners [FIRST, FIRST + CORNERS) of tiles, over their texels: for every image of a batch the sum of r g_k of one term;
// and with WITH_ERROR the sum of r^2 over all of them, blended. DIAGONAL: sum of g_k^2 where a sample is.
#include "model/prelude.glsl"
#define element vec3
#include "model/loss.glsl"
#include "model/lfm.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#include "combine/colours.glsl"
#include "combine/tile_at_one.glsl"
#ifndef FIRST
#define FIRST 0
#define CORNERS 1
#endif
uniform MAPS surface_maps;
uniform usampler2D colours;  // that texels take
uniform sampler2DArray view_values;
const int columns = COLUMNS;
#if defined(WITH_ERROR) || TERMS == 1
const int term = 0;  // a constant, so that residuals and gradient share their look-ups
#else
uniform int term;
#endif
layout(location = 0) out vec4 product[BATCH * CORNERS];  // [image][corner]
#ifdef WITH_ERROR
layout(location = BATCH * CORNERS) out vec4 error[CORNERS];
#endif

vec3 values[BATCH * CORNERS * TERMS];
#ifdef WEIGHTED
float roots[BATCH * CORNERS];  // of the samples' weights
#define WEIGHTED_TARGET(image, c) (roots[(image) * CORNERS + (c)] * target)
#else
#define WEIGHTED_TARGET(image, c) target
#endif

#define LOOK_UP(image) look_up(image, of_tile)
void look_up(int image, uvec4 of_tile) {
    for (int c = 0; c < CORNERS; ++c) {
        int vertex = int(of_tile[FIRST + c]);
        for (int k = 0; k < TERMS; ++k)
            values[(image * CORNERS + c) * TERMS + k] =
                texelFetch(view_values, ivec3(vertex % columns, vertex / columns, image * TERMS + k), 0).rgb;
#ifdef WEIGHTED
        roots[image * CORNERS + c] =
            texelFetch(view_values, ivec3(vertex % columns, vertex / columns, image * TERMS), 0).a;
#endif
    }
}

#define ADD(image) add(image, taken, weights, g, of_term, products, errors)
void add(int image, uvec4 taken, vec3 weights, vec3 g[CORNERS * TERMS], vec3 of_term[CORNERS],
         inout vec3 products[BATCH * CORNERS], inout vec3 errors[CORNERS]) {
    uvec2 colour;
    bool present = kept(taken, image, colour);
    vec3 target = target_of(image, colour);
    for (int c = 0; c < CORNERS; ++c) {
        vec3 r = -weights[FIRST + c] * WEIGHTED_TARGET(image, c);
        for (int k = 0; k < TERMS; ++k)
            r += lfm_value(g[c * TERMS + k], values[(image * CORNERS + c) * TERMS + k]);
        r = present ? r : vec3(0.0);
#ifdef DIAGONAL
        products[image * CORNERS + c] += present ? LOSS_WEIGHTED(r * r, of_term[c] * of_term[c]) : vec3(0.0);
#else
        products[image * CORNERS + c] += lfm_gradient_view(LOSS_WEIGHTED(r * r, r), of_term[c]);
        errors[c] += LOSS_VALUE(r * r);
#endif
    }
}

void main() {
    uvec4 of_tile = texelFetch(tile_vertices, ivec2(gl_FragCoord.xy), 0);
    ivec3 frame = tile_frame(int(of_tile.w), SIDE);
    FOR_EACH_IMAGE(LOOK_UP)
    vec3 products[BATCH * CORNERS], errors[CORNERS];
    for (int i = 0; i < BATCH * CORNERS; ++i) products[i] = vec3(0.0);
    for (int c = 0; c < CORNERS; ++c) errors[c] = vec3(0.0);
    int rows = rows_to_visit();
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < SIDE - j; ++i) {
            ivec2 place = frame.xy + frame.z * ivec2(i, j);
            uvec4 taken = texelFetch(colours, place, 0);
            vec3 weights = cell_barycentric(ivec2(i, j));
            vec3 g[CORNERS * TERMS], of_term[CORNERS];
            for (int c = 0; c < CORNERS; ++c) {
                for (int k = 0; k < TERMS; ++k)
                    g[c * TERMS + k] = load(texelFetch(surface_maps, ivec3(place, (FIRST + c) * TERMS + k), 0));
                of_term[c] = load(texelFetch(surface_maps, ivec3(place, (FIRST + c) * TERMS + term), 0));
            }
            FOR_EACH_IMAGE(ADD)
        }
    for (int i = 0; i < BATCH * CORNERS; ++i) product[i] = vec4(products[i], 0.0);
#ifdef WITH_ERROR
    for (int c = 0; c < CORNERS; ++c) error[c] = vec4(errors[c], 0.0);
#endif
}
