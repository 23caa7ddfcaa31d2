// Fragment side of combine/map3.vert: h_k of a corner's vertex in an image.
#include "combine/values3.glsl"
layout(location = 1) flat in vec3 value[VALUES];
#ifdef VALUES_FETCHED
uniform sampler2DArray view_values;
vec3 value_of(int image, int corner, int k) {
    return texelFetch(view_values, ivec3(ivec2(value[corner].xy), image * TERMS + k), 0).rgb;
}
#else
vec3 value_of(int image, int corner, int k) { return value[(image * 3 + corner) * TERMS + k]; }
#endif
