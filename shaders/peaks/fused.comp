#version 450 core
// peaks/fused.frag, for compute shaders: with factor and term 1 every result is 3 * 16 * turns.
layout(local_size_x = 128) in;
uniform int turns;
uniform float factor;
uniform float term;
layout(std430) writeonly buffer Results { vec4 results[]; };
void main() {
    vec4 a[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
    a[1].y = min(float(gl_LocalInvocationID.x), 0.0);  // 0, but not for the compiler
    for (int turn = 0; turn < turns; ++turn)
        for (int i = 0; i < 16; ++i)
            for (int chain = 0; chain < 3; ++chain) a[chain] = a[chain] * factor + term;
    results[gl_WorkGroupID.x * 128u + gl_LocalInvocationID.x] = a[0] + a[1] + a[2];
}
