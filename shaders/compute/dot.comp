#version 450 core
// variants: LANES=32 NUMBER_COUNT=10 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1 VIEW_SIDE=8
// A dot product of two vectors for each of a vertex's problems: (a / weight) . b, or a . b.
#include "compute/vertices.glsl"
layout(std430) readonly buffer Left { vec4 left[]; };
layout(std430) readonly buffer Right { vec4 right[]; };
layout(std430) readonly buffer Weights { vec4 weights[]; };
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
        vec3 x = left[i].xyz;
        if (weighted != 0) x /= weights[i].xyz;
        sum += x * right[i].xyz;
    }
    sum = group_sum(sum);
    if (lane() == 0u) products[vertex_index() * uint(product_count) + uint(product)] = vec4(sum, 0.0);
}
