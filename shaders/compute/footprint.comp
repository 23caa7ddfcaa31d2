#version 450 core
// variants: LANES=32 VIEW_SIDE=8 WEIGHTED=-,1 NEAREST=-,1
// How the camera sees each vertex: what compute/sample_store.h keeps of all images, of one. An invocation is a vertex.
#include "gather/footprint.glsl"
layout(local_size_x = LANES) in;
uniform samplerBuffer positions;  // [vertex][4]: position, tangent, bitangent, normal
uniform int vertex_count;
layout(std430) writeonly buffer Pairs { uvec4 pairs[]; };  // as compute/look_up.glsl has them
vec3 of_vertex(uint vertex, int i) { return texelFetch(positions, 4 * int(vertex) + i).xyz; }
void main() {
    uint v = (gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * uint(LANES) + gl_LocalInvocationID.x;
    if (v >= uint(vertex_count)) return;
    vec4 weights;
    vec2 texel;
    float root;
    footprint_of(of_vertex(v, 0), of_vertex(v, 1), of_vertex(v, 2), of_vertex(v, 3), weights, texel, root);
    pairs[2u * v] = floatBitsToUint(weights * root);
    pairs[2u * v + 1u] = uvec4(uint(texel.y) * uint(VIEW_SIDE) + uint(texel.x), floatBitsToUint(root), v, 0u);
}
