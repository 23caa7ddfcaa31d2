// Fragment side of combine/map3.vert: h_k of a corner's vertex in an image; and a target of it, times the root of its weight.
#include "combine/values3.glsl"
layout(location = 1) flat in VIEW_VALUE value[VALUES];
#ifdef VALUES_FETCHED
uniform sampler2DArray view_values;
vec4 whole_value_of(int image, int corner, int k) {
    return texelFetch(view_values, ivec3(ivec2(value[corner].xy), image * TERMS + k), 0);
}
#else
VIEW_VALUE whole_value_of(int image, int corner, int k) { return value[(image * 3 + corner) * TERMS + k]; }
#endif
vec3 value_of(int image, int corner, int k) { return whole_value_of(image, corner, k).rgb; }
#ifdef WEIGHTED
vec3 weighted(int image, int corner, vec3 target) { return whole_value_of(image, corner, 0).a * target; }
#else
vec3 weighted(int image, int corner, vec3 target) { return target; }
#endif
