#version 450 core
// variants: MODEL=* STORAGE=0,1
// A dot product per texel: (a / weight) . b, or a . b.
#include "reflect/parameters.glsl"
uniform MAPS left;
uniform MAPS right;
uniform MAPS weights;
uniform int weighted;
layout(location = 0) out vec4 product;
void main() {
    vec3 sum = vec3(0.0);
    for (int map = 0; map < MAP_COUNT; ++map) {
        ivec3 at = ivec3(ivec2(gl_FragCoord.xy), map);
        vec3 x = load(texelFetch(left, at, 0));
        if (weighted != 0) {
            vec3 weight = load(texelFetch(weights, at, 0));
            x = mix(x, x / weight, notEqual(weight, vec3(0.0)));
        }
        sum += x * load(texelFetch(right, at, 0));
    }
    product = vec4(dot(sum, vec3(1.0)), 0.0, 0.0, 0.0);
}
