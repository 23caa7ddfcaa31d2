// Fragment side of map.vert: h_k, and dh_k along d, of the corner's vertex in this image.
#ifndef VALUES
#define VALUES 0
#endif
layout(location = 5) flat in ivec2 problem;
uniform sampler2DArray view_values;
#if VALUES > 0
layout(location = 6) flat in vec3 value[VALUES];
vec3 view_value(int k) { return value[k]; }
#else
vec3 view_value(int k) { return texelFetch(view_values, ivec3(problem, k), 0).rgb; }
#endif
#ifdef ALONG
#if VALUES > 0
layout(location = 14) flat in vec3 slope[VALUES];
vec3 view_slope(int k) { return slope[k]; }
#else
uniform sampler2DArray view_slopes;
vec3 view_slope(int k) { return texelFetch(view_slopes, ivec3(problem, k), 0).rgb; }
#endif
#endif
