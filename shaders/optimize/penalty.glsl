// lambda E_r + mu E_b (Eq. 11) of one texel and term; C++ face: model/penalty.h. The laplacian of x (or of d, along d)
// is in `laplacian`; the first term alone has bounds.
#include "optimize/site.glsl"
uniform MAPS parameters;  // x
uniform MAPS direction;  // d
uniform sampler2DArray laplacian;  // L x, layer site_corner
uniform sampler2DArray sample_sums;  // sums over samples, layers as maps
uniform sampler2DArray problem_constants;  // per problem; layer 0: 1/S-bar, ring texels; 1: lambda_view
uniform sampler2D largest_diagonal;  // per problem: the largest entry of P
uniform int term;
uniform float lambda_surface;
uniform float mu;  // 0 beyond the first term
uniform vec2 bounds;
uniform int paper_penalty;  // 1: the printed penalty, whose gradient jumps at the bound

vec3 smoothness() {
#ifdef VIEW_MAPS
    return texelFetch(problem_constants, ivec3(site_problem(), 1), 0).rgb;
#else
    return vec3(lambda_surface);
#endif
}
float inverse_density() { return texelFetch(problem_constants, ivec3(site_problem(), 0), 0).r; }
vec3 x_here() { return load(texelFetch(parameters, site_texel(term), 0)); }
bvec3 beyond(vec3 x) {
    return bvec3(x.r < bounds.x || x.r > bounds.y, x.g < bounds.x || x.g > bounds.y, x.b < bounds.x || x.b > bounds.y);
}
vec3 distance_beyond(vec3 x) { return x - clamp(x, bounds.x, bounds.y); }
vec3 bound_error(vec3 x) {
    vec3 e = paper_penalty != 0 ? (x - bounds.x) * (x - bounds.y) : 0.5 * distance_beyond(x) * distance_beyond(x);
    return mix(vec3(0.0), mu * e, beyond(x));
}
vec3 bound_slope(vec3 x) {
    vec3 g = paper_penalty != 0 ? 2.0 * x - bounds.x - bounds.y : distance_beyond(x);
    return mix(vec3(0.0), mu * g, beyond(x));
}
vec3 bound_curvature(vec3 x) { return mix(vec3(0.0), vec3(mu * (paper_penalty != 0 ? 2.0 : 1.0)), beyond(x)); }
