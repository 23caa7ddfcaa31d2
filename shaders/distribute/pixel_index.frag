#version 450 core
// The distribution itself, for sample lists: row * width + column of the pixel that each texel takes.
#include "distribute/take.glsl"
layout(location = 0) out uint taken;
void main() {
    ivec2 pixel;
    uvec4 channels;
    vec3 weights;
    bool present = take(pixel, channels, weights);
    taken = present ? uint(pixel.y) * uint(image_size.x) + uint(pixel.x) : 0xffffffffu;
}
