#version 450 core
// peaks/fused.frag, for compute shaders.
layout(local_size_x = 128) in;
uniform int turns;
uniform float factor;
uniform float term;
uniform vec4 starts[3];
layout(std430) writeonly buffer Results { vec4 results[]; };
void main() {
    vec4 a[3] = starts;
    for (int turn = 0; turn < turns; ++turn)
        for (int i = 0; i < 16; ++i)
            for (int chain = 0; chain < 3; ++chain) a[chain] = a[chain] * factor + term;
    results[gl_WorkGroupID.x * 128u + gl_LocalInvocationID.x] = a[0] + a[1] + a[2];
}
