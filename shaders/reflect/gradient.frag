#version 450 core
// variants: MODEL=* STORAGE=0,1
// One map of E's gradient: sums over samples / S-bar + mu dE_b.
#include "reflect/parameters.glsl"
#include "reflect/bounds.glsl"
layout(binding = 5) uniform MAPS parameters;
layout(binding = 11) uniform sampler2DArray sums;
layout(binding = 12) uniform sampler2D density;  // 1 / S-bar
layout(location = 10) uniform int map;
layout(location = 0) out STORED gradient;
void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    ivec3 at = ivec3(place, map);
    vec3 data = texelFetch(sums, at, 0).rgb * texelFetch(density, place, 0).r;
    gradient = store(data + bound_slope(map, load(texelFetch(parameters, at, 0))));
}
