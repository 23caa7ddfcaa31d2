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
    vec3 least = 1.0e-4 * texelFetch(largest_diagonal, site_problem(), 0).rgb + 1.0e-30;
#if STORAGE != 0
    least = max(least, vec3(6.0e-5));  // binary16 ends there, and a zero would divide
#endif
    precondition = store(mix(least, entry, greaterThan(entry, least)));
#else
    precondition = vec4(entry, 0.0);
#endif
}
