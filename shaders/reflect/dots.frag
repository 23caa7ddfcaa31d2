#version 450 core
// variants: MODEL=* STORAGE=0,1
// Per texel z'.g', z'.g and d.g' with z = g / P, or g.
#include "reflect/parameters.glsl"
layout(binding = 1) uniform MAPS trial_gradient;
layout(binding = 2) uniform MAPS gradient;
layout(binding = 3) uniform MAPS direction;
layout(binding = 4) uniform MAPS precondition;
layout(location = 18) uniform int preconditioned;
layout(location = 0) out vec4 products;
void main() {
    vec3 norm = vec3(0.0), cross_term = vec3(0.0), conjugate = vec3(0.0);
    for (int map = 0; map < MAP_COUNT; ++map) {
        ivec3 at = ivec3(ivec2(gl_FragCoord.xy), map);
        vec3 g = load(texelFetch(trial_gradient, at, 0)), z = g;
        if (preconditioned != 0) {
            vec3 weight = load(texelFetch(precondition, at, 0));
            z = mix(g, g / weight, notEqual(weight, vec3(0.0)));
        }
        norm += z * g;
        cross_term += z * load(texelFetch(gradient, at, 0));
        conjugate += g * load(texelFetch(direction, at, 0));
    }
    products = vec4(dot(norm, vec3(1.0)), dot(cross_term, vec3(1.0)), dot(conjugate, vec3(1.0)), 0.0);
}
