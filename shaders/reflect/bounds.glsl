// mu E_b (Eq. 11) of a map of a texel's parameters.
#include "model/vec3_element.glsl"
#include "model/bounds.glsl"
uniform float mu;
uniform int paper_penalty;  // 1: as printed
uniform vec4 lowest[MAP_COUNT];  // as the parameters are laid out
uniform vec4 highest[MAP_COUNT];

// HELD: some parameters are, whose bounds meet. 0 there.
#ifdef HELD
vec3 where_free(int map, vec3 x) { return mix(x, vec3(0.0), equal(lowest[map].rgb, highest[map].rgb)); }
#else
vec3 where_free(int map, vec3 x) { return x; }
#endif
vec3 bound_error(int map, vec3 x) { return bound_error(x, lowest[map].rgb, highest[map].rgb, mu, paper_penalty != 0); }
vec3 bound_slope(int map, vec3 x) { return bound_slope(x, lowest[map].rgb, highest[map].rgb, mu, paper_penalty != 0); }
vec3 bound_curvature(int map, vec3 x, vec3 d) {
    return bound_curvature(x, d, lowest[map].rgb, highest[map].rgb, mu, paper_penalty != 0);
}
