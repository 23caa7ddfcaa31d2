#version 450 core
// variants: MODEL=* STORAGE=0,1
// One map of E's gradient: sums over samples / S-bar + mu dE_b.
#include "reflect/parameters.glsl"
#include "reflect/bounds.glsl"
uniform MAPS parameters;
uniform sampler2DArray sample_sums;
uniform sampler2D inverse_samples;  // 1 / S-bar
uniform int map;
layout(location = 0) out STORED gradient;
void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    ivec3 at = ivec3(place, map);
    vec3 data = texelFetch(sample_sums, at, 0).rgb * texelFetch(inverse_samples, place, 0).r;
    gradient = store(where_free(map, data + bound_slope(map, load(texelFetch(parameters, at, 0)))));
}
