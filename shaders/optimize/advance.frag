#version 450 core
// trial <- p + trial_step d.
#include "optimize/site.glsl"
#include "optimize/state.glsl"
layout(binding = 0) uniform MAPS p;
layout(binding = 6) uniform MAPS d;
layout(location = 10) uniform int term;
layout(location = 0) out STORED trial;
void main() {
    ivec2 at = site_problem();
    vec3 alpha = texelFetch(steps, at, 0).rgb;
    vec3 taken;
    for (int c = 0; c < 3; ++c) taken[c] = trial_step(read_state(at, c), alpha[c]);
    trial = store(load(texelFetch(p, site_texel(term), 0)) + taken * load(texelFetch(d, site_texel(term), 0)));
}
