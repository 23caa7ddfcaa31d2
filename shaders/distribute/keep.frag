#version 450 core
// The channels of the pixel that each texel takes of an image; alpha is 0 where it takes none.
#include "distribute/take.glsl"
layout(location = 0) out uvec4 kept;
void main() {
    ivec2 pixel;
    uvec4 channels;
    vec3 weights;
    bool present = take(pixel, channels, weights);
    kept = present ? channels : uvec4(0u);
}
