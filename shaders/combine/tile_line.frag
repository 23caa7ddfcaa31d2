#version 450 core
// The sums along d of one corner's tiles for one image, blended over images: a tile's fragment projects each of its
// texels, takes its pixel and adds its terms (Eq. 13). QUARTIC: the two further sums. COUNT: sum of L t and samples.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "distribute/camera.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#include "combine/tile_at_one.glsl"
layout(binding = 0) uniform usampler2D items;
layout(binding = 1) uniform usampler2D image;
layout(binding = 2) uniform MAPS surface;
layout(binding = 3) uniform MAPS surface_direction;
layout(binding = 5) uniform sampler2DArray view_values;
layout(binding = 6) uniform sampler2DArray view_slopes;
layout(binding = 9) uniform sampler2DArray vertices;     // layer 0: position
layout(binding = 10) uniform usampler2D tile_vertices;   // per tile
layout(location = 5) uniform int layout_width;
layout(location = 8) uniform int corner;
layout(location = 9) uniform int columns;
layout(location = 11) uniform float target_scale;
layout(location = 12) uniform int widen;
#ifdef COUNT
layout(location = 0) out vec4 total;
#else
layout(location = 0) out vec4 gauss_newton;
layout(location = 1) out vec4 curvature;
#ifdef QUARTIC
layout(location = 2) out vec4 third;
layout(location = 3) out vec4 fourth;
#endif
#endif

ivec2 problem_of(uint vertex) { return ivec2(int(vertex) % columns, int(vertex) / columns); }

void main() {
    ivec3 frame = tile_frame(whole_tile(), SIDE);
    uvec3 of_tile = texelFetch(tile_vertices, ivec2(gl_FragCoord.xy), 0).xyz;
    vec3 q0 = project(texelFetch(vertices, ivec3(problem_of(of_tile.x), 0), 0).xyz);
    vec3 q1 = project(texelFetch(vertices, ivec3(problem_of(of_tile.y), 0), 0).xyz);
    vec3 q2 = project(texelFetch(vertices, ivec3(problem_of(of_tile.z), 0), 0).xyz);
    ivec2 problem = problem_of(corner == 0 ? of_tile.x : corner == 1 ? of_tile.y : of_tile.z);
    vec4 aa = vec4(0.0);
    vec3 arb = vec3(0.0), ab = vec3(0.0), bb = vec3(0.0);
#ifndef COUNT
    vec3 value[TERMS], slope[TERMS];
    for (int k = 0; k < TERMS; ++k) {
        value[k] = texelFetch(view_values, ivec3(problem, k), 0).rgb;
        slope[k] = texelFetch(view_slopes, ivec3(problem, k), 0).rgb;
    }
#endif
    int rows = rows_to_visit();
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < SIDE - j; ++i) {
            ivec2 place = frame.xy + frame.z * ivec2(i, j);
            vec3 weights = cell_barycentric(ivec2(i, j));
            precise vec3 q = weights.x * q0 + weights.y * q1 + weights.z * q2;
            precise vec2 at = floor(q.xy / q.z);
            bool inside = all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, image_size));
            ivec2 pixel = inside ? ivec2(at) : ivec2(0);
            uvec4 channels = texelFetch(image, pixel, 0);
            bool present = inside && texelFetch(items, pixel, 0).r == uint(place.y * layout_width + place.x) &&
                           channels.a != 0u;
            vec3 t = (weights[corner] * target_scale) * vec3(channels.rgb * uint(widen));
#ifdef COUNT
            aa += present ? vec4(t, 1.0) : vec4(0.0);
#else
            vec3 r = -t, a = vec3(0.0), b = vec3(0.0);
            for (int k = 0; k < TERMS; ++k) {
                vec3 g = load(texelFetch(surface, ivec3(place, corner * TERMS + k), 0));
                vec3 dg = load(texelFetch(surface_direction, ivec3(place, corner * TERMS + k), 0));
                r += lfm_value(g, value[k]);
                a += lfm_slope(g, value[k], dg, slope[k]);
                b += lfm_bend(dg, slope[k]);
            }
            aa.rgb += present ? a * a : vec3(0.0);
            arb += present ? a * a + 2.0 * r * b : vec3(0.0);
#ifdef QUARTIC
            ab += present ? a * b : vec3(0.0);
            bb += present ? b * b : vec3(0.0);
#endif
#endif
        }
#ifdef COUNT
    total = aa;
#else
    gauss_newton = vec4(aa.rgb, 0.0);
    curvature = vec4(arb, 0.0);
#ifdef QUARTIC
    third = vec4(ab, 0.0);
    fourth = vec4(bb, 0.0);
#endif
#endif
}
