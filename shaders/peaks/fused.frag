#version 450 core
// A device's peak of arithmetic: multiply-adds in twelve chains a fragment, which registers hold. With factor and term 1
// the result is 3 * 16 * turns.
uniform int turns;
uniform float factor;
uniform float term;
layout(location = 0) out vec4 result;
void main() {
    vec4 a[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
    a[1].y = min(gl_FragCoord.x, 0.0);  // 0, but not for the compiler
    for (int turn = 0; turn < turns; ++turn)
        for (int i = 0; i < 16; ++i)
            for (int chain = 0; chain < 3; ++chain) a[chain] = a[chain] * factor + term;
    result = a[0] + a[1] + a[2];
}
