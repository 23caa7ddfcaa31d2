// lambda E_r + mu E_b (Eq. 11) of one texel and term; C++ face: model/penalty.h. The laplacian of x (or of d, along d)
// is in `laplacian`; the first term alone has bounds.
#include "model/vec3_element.glsl"
#include "model/bounds.glsl"
#include "model/precondition.glsl"
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
uniform int paper_penalty;  // 1: as printed

vec3 smoothness() {
#ifdef VIEW_MAPS
    return texelFetch(problem_constants, ivec3(site_problem(), 1), 0).rgb;
#else
    return vec3(lambda_surface);
#endif
}
float inverse_density() { return texelFetch(problem_constants, ivec3(site_problem(), 0), 0).r; }
vec3 x_here() { return load(texelFetch(parameters, site_texel(term), 0)); }
vec3 bound_error(vec3 x) { return bound_error(x, vec3(bounds.x), vec3(bounds.y), mu, paper_penalty != 0); }
vec3 bound_slope(vec3 x) { return bound_slope(x, vec3(bounds.x), vec3(bounds.y), mu, paper_penalty != 0); }
vec3 bound_curvature(vec3 x, vec3 d) {
    return bound_curvature(x, d, vec3(bounds.x), vec3(bounds.y), mu, paper_penalty != 0);
}
