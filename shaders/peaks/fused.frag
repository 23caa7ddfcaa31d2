#version 450 core
// A device's peak of arithmetic: multiply-adds in twelve chains a fragment, which registers hold. Each begins at a number of
// its own, so that no compiler makes one of two; factor is not 1, so that none leaves out the product.
uniform int turns;
uniform float factor;
uniform float term;
uniform vec4 starts[3];
layout(location = 0) out vec4 result;
void main() {
    vec4 a[3] = starts;
    for (int turn = 0; turn < turns; ++turn)
        for (int i = 0; i < 16; ++i)
            for (int chain = 0; chain < 3; ++chain) a[chain] = a[chain] * factor + term;
    result = a[0] + a[1] + a[2];
}
