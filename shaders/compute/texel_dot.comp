#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 MODEL=*
// A dot product of two vectors for each texel: (a / weight) . b, or a . b.
#include "optimize/dialect.glsl"
#include "compute/texels.glsl"
uniform samplerBuffer left;
uniform samplerBuffer right;
uniform samplerBuffer weights;
layout(std430) writeonly buffer Products { float products[]; };  // [product][texel]
uniform int weighted;
uniform int product;
void main() {
    if (!is_active()) return;
    vec3 sum = vec3(0.0);
    for (int map = 0; map < MAP_COUNT; ++map) {
        int at = int(element_index(map));
        vec3 x = texelFetch(left, at).rgb;
        if (weighted != 0) {
            vec3 weight = texelFetch(weights, at).rgb;
            x = mix(x, x / weight, notEqual(weight, vec3(0.0)));
        }
        sum += x * texelFetch(right, at).rgb;
    }
    products[uint(product) * uint(texel_count) + texel_index()] = sum.r + sum.g + sum.b;
}
