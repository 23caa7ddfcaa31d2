// mu E_b (Eq. 11) of all parameters of a texel; C++ face: model/penalty.h.
uniform float mu;
uniform int paper_penalty;  // 1: the printed penalty, whose gradient jumps at the bound
uniform vec4 lowest[MAP_COUNT];  // as the parameters are laid out; what stands for none is unbound
uniform vec4 highest[MAP_COUNT];

bvec3 beyond(int map, vec3 x) {
    return not(bvec3(x.r >= lowest[map].r && x.r <= highest[map].r, x.g >= lowest[map].g && x.g <= highest[map].g,
                     x.b >= lowest[map].b && x.b <= highest[map].b));
}
vec3 distance_beyond(int map, vec3 x) { return x - clamp(x, lowest[map].rgb, highest[map].rgb); }
vec3 bound_error(int map, vec3 x) {
    vec3 e = paper_penalty != 0 ? (x - lowest[map].rgb) * (x - highest[map].rgb)
                                : 0.5 * distance_beyond(map, x) * distance_beyond(map, x);
    return mix(vec3(0.0), mu * e, beyond(map, x));
}
vec3 bound_slope(int map, vec3 x) {
    vec3 g = paper_penalty != 0 ? 2.0 * x - lowest[map].rgb - highest[map].rgb : distance_beyond(map, x);
    return mix(vec3(0.0), mu * g, beyond(map, x));
}
vec3 bound_curvature(int map, vec3 x) { return mix(vec3(0.0), vec3(mu * (paper_penalty != 0 ? 2.0 : 1.0)), beyond(map, x)); }
