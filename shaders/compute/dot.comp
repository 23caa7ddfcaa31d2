#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1 VIEW_SIDE=8
// A dot product of two vectors for each of a vertex's problems: (a / weight) . b, or a . b.
#include "compute/vertices.glsl"
uniform samplerBuffer left;
uniform samplerBuffer right;
uniform samplerBuffer weights;
layout(std430) buffer Products { vec4 products[]; };  // [vertex][product_count]
uniform int weighted;
uniform int product;
uniform int product_count;
void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    vec3 sum = vec3(0.0);
    uint end = v.view_first + uint(VIEW_SIDE * VIEW_SIDE * TERMS);
    for (uint i = v.first + lane(); i < end; i += uint(LANES)) {
        vec3 x = texelFetch(left, int(i)).xyz;
        if (weighted != 0) {
            vec3 weight = texelFetch(weights, int(i)).xyz;
            x = mix(x, x / weight, notEqual(weight, vec3(0.0)));
        }
        sum += x * texelFetch(right, int(i)).xyz;
    }
    sum = group_sum(sum);
    if (lane() == 0u) products[vertex_index() * uint(product_count) + uint(product)] = vec4(sum, 0.0);
}
