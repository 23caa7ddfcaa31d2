#version 450 core
// Per tile and corner, over its texels: sum of r g_k of one term, and with WITH_ERROR sum of r^2, blended over images.
// DIAGONAL: sum of g_k^2 where a sample is.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#include "combine/target_of.glsl"
#include "combine/tile_at_one.glsl"
layout(binding = 2) uniform MAPS surface;
layout(binding = 4) uniform usampler2D colours;  // that texels take; alpha 1 where one is
layout(binding = 5) uniform sampler2DArray view_values;
const int columns = COLUMNS;
#if defined(WITH_ERROR) || TERMS == 1
const int term = 0;  // a constant, so that residuals and gradient share their look-ups
#else
layout(location = 10) uniform int term;
#endif
layout(location = 0) out vec4 product[3];
#ifdef WITH_ERROR
layout(location = 3) out vec4 error[3];
#endif

vec3 values[3 * TERMS];
vec3 value_of(int corner, int k) { return values[corner * TERMS + k]; }
#include "combine/residual3.glsl"

void main() {
    uvec4 of_tile = texelFetch(tile_vertices, ivec2(gl_FragCoord.xy), 0);
    ivec3 frame = tile_frame(int(of_tile.w), SIDE);
    for (int corner = 0; corner < 3; ++corner) {
        int vertex = int(of_tile[corner]);
        for (int k = 0; k < TERMS; ++k)
            values[corner * TERMS + k] =
                texelFetch(view_values, ivec3(vertex % columns, vertex / columns, k), 0).rgb;
    }
    vec3 products[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 errors[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
    int rows = rows_to_visit();
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < SIDE - j; ++i) {
            ivec2 place = frame.xy + frame.z * ivec2(i, j);
            uvec4 taken = texelFetch(colours, place, 0);
            vec3 target = target_of(taken.rgb);
            vec3 weights = cell_barycentric(ivec2(i, j));
            for (int corner = 0; corner < 3; ++corner) {
                vec3 g = load(texelFetch(surface, ivec3(place, corner * TERMS + term), 0));
#ifdef DIAGONAL
                products[corner] += taken.a != 0u ? g * g : vec3(0.0);
#else
                vec3 r = residual_of(corner, target, weights, place);
                r = taken.a != 0u ? r : vec3(0.0);
                products[corner] += lfm_gradient_view(r, g);
                errors[corner] += r * r;
#endif
            }
        }
    for (int corner = 0; corner < 3; ++corner) {
        product[corner] = vec4(products[corner], 0.0);
#ifdef WITH_ERROR
        error[corner] = vec4(errors[corner], 0.0);
#endif
    }
}
