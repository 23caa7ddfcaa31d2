#version 450 core
// The sums along d of corners [FIRST, FIRST + CORNERS) of tiles for one image, blended over images: a tile's fragment
// projects each of its texels, takes its pixel and adds its terms (Eq. 13). QUARTIC: with the two further sums. COUNT:
// sum of L t and samples.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "distribute/camera.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#include "combine/tile_at_one.glsl"
#include "combine/take_item.glsl"
#ifndef FIRST
#define FIRST 0
#define CORNERS 2
#endif
layout(binding = 2) uniform MAPS surface;
layout(binding = 3) uniform MAPS surface_direction;
layout(binding = 5) uniform sampler2DArray view_values;
layout(binding = 6) uniform sampler2DArray view_slopes;
layout(binding = 9) uniform sampler2DArray vertices;     // layer 0: position
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

void main() {
    uvec4 of_tile = texelFetch(tile_vertices, ivec2(gl_FragCoord.xy), 0);
    ivec3 frame = tile_frame(int(of_tile.w), SIDE);
    vec3 q0 = project(texelFetch(vertices, ivec3(problem_of(of_tile.x), 0), 0).xyz);
    vec3 q1 = project(texelFetch(vertices, ivec3(problem_of(of_tile.y), 0), 0).xyz);
    vec3 q2 = project(texelFetch(vertices, ivec3(problem_of(of_tile.z), 0), 0).xyz);
    vec4 aa[CORNERS];
    vec3 arb[CORNERS], ab[CORNERS], bb[CORNERS];
    vec3 value[CORNERS * TERMS], slope[CORNERS * TERMS];
    for (int c = 0; c < CORNERS; ++c) {
        aa[c] = vec4(0.0);
        arb[c] = ab[c] = bb[c] = vec3(0.0);
#ifndef COUNT
        ivec2 problem = problem_of(of_tile[FIRST + c]);
        for (int k = 0; k < TERMS; ++k) {
            value[c * TERMS + k] = texelFetch(view_values, ivec3(problem, k), 0).rgb;
            slope[c * TERMS + k] = texelFetch(view_slopes, ivec3(problem, k), 0).rgb;
        }
#endif
    }
    int rows = rows_to_visit();
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < SIDE - j; ++i) {
            ivec2 place = frame.xy + frame.z * ivec2(i, j);
            vec3 weights = cell_barycentric(ivec2(i, j));
            uvec3 channels;
            bool present = take_item(q0, q1, q2, weights, place, image_size, channels);
            vec3 target = target_of(channels);
            for (int c = 0; c < CORNERS; ++c) {
                vec3 t = weights[FIRST + c] * target;
#ifdef COUNT
                aa[c] += present ? vec4(t, 1.0) : vec4(0.0);
#else
                vec3 r = -t, a = vec3(0.0), b = vec3(0.0);
                for (int k = 0; k < TERMS; ++k) {
                    ivec3 at = ivec3(place, (FIRST + c) * TERMS + k);
                    vec3 g = load(texelFetch(surface, at, 0)), h = value[c * TERMS + k];
                    vec3 dg = load(texelFetch(surface_direction, at, 0)), dh = slope[c * TERMS + k];
                    r += lfm_value(g, h);
                    a += lfm_slope(g, h, dg, dh);
                    b += lfm_bend(dg, dh);
                }
                // Where no pixel is taken all three are nothing, and so are their products.
                r = present ? r : vec3(0.0);
                a = present ? a : vec3(0.0);
                b = present ? b : vec3(0.0);
                aa[c].rgb += a * a;
                arb[c] += a * a + 2.0 * r * b;
#ifdef QUARTIC
                ab[c] += a * b;
                bb[c] += b * b;
#endif
#endif
            }
        }
    for (int c = 0; c < CORNERS; ++c) {
#ifdef COUNT
        total[c] = aa[c];
#else
        gauss_newton[c] = vec4(aa[c].rgb, 0.0);
        curvature[c] = vec4(arb[c], 0.0);
#ifdef QUARTIC
        third[c] = vec4(ab[c], 0.0);
        fourth[c] = vec4(bb[c], 0.0);
#endif
#endif
    }
}
