#version 450 core
// peaks/copy.frag, for compute shaders: one large buffer into another, read as the engines' passes read.
layout(local_size_x = 128) in;
uniform samplerBuffer source;
layout(std430) writeonly buffer Results { vec4 results[]; };
void main() {
    uint i = (gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * 128u + gl_LocalInvocationID.x;
    if (i >= uint(results.length())) return;
    results[i] = texelFetch(source, int(i));
}
