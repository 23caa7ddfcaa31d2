#version 450 core
// Where accepted: p <- trial, g <- trial gradient, P <- fresh P. Then d <- -z + beta d (Eq. 6). Reads and writes its own
// texel only.
#include "optimize/site.glsl"
layout(binding = 0) uniform MAPS p;
layout(binding = 1) uniform MAPS trial;
layout(binding = 2) uniform MAPS g;
layout(binding = 3) uniform MAPS trial_gradient;
layout(binding = 4) uniform MAPS precondition;
layout(binding = 5) uniform MAPS fresh_precondition;
layout(binding = 6) uniform MAPS d;
layout(binding = 7) uniform sampler2DArray state;  // one layer per field of ProblemState
layout(location = 10) uniform int term;
layout(location = 18) uniform int preconditioned;
layout(location = 19) uniform int fresh;
layout(location = 0) out STORED new_p;
layout(location = 1) out STORED new_g;
layout(location = 2) out STORED new_precondition;
layout(location = 3) out STORED new_d;
void main() {
    ivec3 at = site_texel(term);
    bvec3 accepted = notEqual(texelFetch(state, ivec3(site_problem(), 5), 0).rgb, vec3(0.0));
    vec3 beta = texelFetch(state, ivec3(site_problem(), 4), 0).rgb;
    vec3 gradient = mix(load(texelFetch(g, at, 0)), load(texelFetch(trial_gradient, at, 0)), accepted);
    vec3 weight = load(texelFetch(precondition, at, 0));
    if (fresh != 0) weight = mix(weight, load(texelFetch(fresh_precondition, at, 0)), accepted);
    vec3 z = gradient;
    if (preconditioned != 0) z = mix(gradient, gradient / weight, notEqual(weight, vec3(0.0)));
    new_p = store(mix(load(texelFetch(p, at, 0)), load(texelFetch(trial, at, 0)), accepted));
    new_g = store(gradient);
    new_precondition = store(weight);
    new_d = store(beta * load(texelFetch(d, at, 0)) - z);
}
