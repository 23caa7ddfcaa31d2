#version 450 core
// One map of: where accepted, p <- trial, g <- trial gradient, P <- fresh P; then d <- -z + beta d (Eq. 6). Reads and
// writes its own texel only.
#include "gather/maps.glsl"
#include "reflect/state.glsl"
layout(binding = 0) uniform MAPS p;
layout(binding = 1) uniform MAPS trial;
layout(binding = 2) uniform MAPS g;
layout(binding = 3) uniform MAPS trial_gradient;
layout(binding = 4) uniform MAPS precondition;
layout(binding = 5) uniform MAPS fresh_precondition;
layout(binding = 6) uniform MAPS d;
layout(location = 10) uniform int map;
layout(location = 18) uniform int preconditioned;
layout(location = 19) uniform int fresh;
layout(location = 0) out STORED new_p;
layout(location = 1) out STORED new_g;
layout(location = 2) out STORED new_precondition;
layout(location = 3) out STORED new_d;
void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    ivec3 at = ivec3(place, map);
    ProblemState s = read_state(place);
    bvec3 accepted = bvec3(s.accepted != 0.0);
    vec3 gradient = mix(load(texelFetch(g, at, 0)), load(texelFetch(trial_gradient, at, 0)), accepted);
    vec3 weight = load(texelFetch(precondition, at, 0));
    if (fresh != 0) weight = mix(weight, load(texelFetch(fresh_precondition, at, 0)), accepted);
    vec3 z = gradient;
    if (preconditioned != 0) z = mix(gradient, gradient / weight, notEqual(weight, vec3(0.0)));
    new_p = store(mix(load(texelFetch(p, at, 0)), load(texelFetch(trial, at, 0)), accepted));
    new_g = store(gradient);
    new_precondition = store(weight);
    new_d = store(s.beta * load(texelFetch(d, at, 0)) - z);
}
