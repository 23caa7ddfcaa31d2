#version 450 core
// P = diag(J'J) / S-bar + 20 lambda. FLOORED: not below 1e-4 of the problem's largest entry, and stored.
#include "optimize/penalty.glsl"
#ifdef FLOORED
layout(location = 0) out STORED precondition;
#else
layout(location = 0) out vec4 precondition;
#endif
void main() {
    vec3 entry = texelFetch(sample_sums, site_texel(term), 0).rgb * inverse_density() + 20.0 * smoothness();
#ifdef FLOORED
    precondition = store_positive(preconditioner(entry, texelFetch(largest_diagonal, site_problem(), 0).rgb, vec3(1.0e-30)));
#else
    precondition = vec4(entry, 0.0);
#endif
}
