#version 450 core
// variants: MODEL=* STORAGE=0,1 ALONG=-,1
// mu E_b of each texel, or ALONG d its second derivative.
#include "reflect/parameters.glsl"
#include "reflect/bounds.glsl"
uniform MAPS parameters;
uniform MAPS direction;
layout(location = 0) out vec4 penalty;
void main() {
    vec3 sum = vec3(0.0);
    for (int map = 0; map < MAP_COUNT; ++map) {
        ivec3 at = ivec3(ivec2(gl_FragCoord.xy), map);
        vec3 x = load(texelFetch(parameters, at, 0));
#ifdef ALONG
        vec3 d = load(texelFetch(direction, at, 0));
        sum += bound_curvature(map, x, d);
#else
        sum += bound_error(map, x);
#endif
    }
    penalty = vec4(sum.r + sum.g + sum.b, 0.0, 0.0, 0.0);
}
