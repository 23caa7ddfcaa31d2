#version 450 core
// One map of trial <- p + trial_step d.
#include "gather/maps.glsl"
#include "reflect/state.glsl"
#include "optimize/after_line.glsl"
layout(binding = 0) uniform MAPS p;
layout(binding = 6) uniform MAPS d;
layout(location = 10) uniform int map;
layout(location = 0) out STORED trial;
void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    ivec3 at = ivec3(place, map);
    float taken = trial_step(read_state(place), texelFetch(lengths, place, 0).r);
    trial = store(load(texelFetch(p, at, 0)) + taken * load(texelFetch(d, at, 0)));
}
