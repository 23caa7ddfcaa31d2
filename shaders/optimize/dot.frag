#version 450 core
// One texel's share of a dot product per problem: PRODUCT 0: z'.g', 1: z'.g, 2: d.g'. z = g / P, or g.
#include "optimize/site.glsl"
#ifndef PRODUCT
#define PRODUCT 0
#endif
layout(binding = 2) uniform MAPS trial_gradient;
layout(binding = 3) uniform MAPS other;  // g or d
layout(binding = 4) uniform MAPS precondition;
layout(location = 18) uniform int preconditioned;
layout(location = 0) out vec4 product;
void main() {
    vec3 sum = vec3(0.0);
    for (int k = 0; k < TERMS; ++k) {
        vec3 slope = load(texelFetch(trial_gradient, site_texel(k), 0));
#if PRODUCT == 0
        vec3 with = slope;
#else
        vec3 with = load(texelFetch(other, site_texel(k), 0));
#endif
#if PRODUCT != 2
        if (preconditioned != 0) {
            vec3 weight = load(texelFetch(precondition, site_texel(k), 0));
            slope = mix(slope, slope / weight, notEqual(weight, vec3(0.0)));
        }
#endif
        sum += slope * with;
    }
    product = vec4(sum, 0.0);
}
