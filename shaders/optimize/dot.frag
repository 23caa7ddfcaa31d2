#version 450 core
// variants: STORAGE=0,1 VIEW_MAPS=-,1 TOGETHER=-,1
// One texel's share of a dot product per problem: (a / weight) . b, or a . b. TOGETHER: channels are of one problem.
#include "optimize/site.glsl"
uniform MAPS left;
uniform MAPS right;
uniform MAPS weights;
uniform int weighted;
layout(location = 0) out vec4 product;
void main() {
    vec3 sum = vec3(0.0);
    for (int k = 0; k < TERMS; ++k) {
        vec3 x = load(texelFetch(left, site_texel(k), 0));
        if (weighted != 0) {
            vec3 weight = load(texelFetch(weights, site_texel(k), 0));
            x = mix(x, x / weight, notEqual(weight, vec3(0.0)));
        }
        sum += x * load(texelFetch(right, site_texel(k), 0));
    }
#ifdef TOGETHER
    sum = vec3(dot(sum, vec3(1.0)), 0.0, 0.0);
#endif
    product = vec4(sum, 0.0);
}
