#version 450 core
// variants: COLOUR=8,16
// The colour of the pixel that each texel takes of an image, in words, and above it whether it takes one.
#include "distribute/take.glsl"
#include "combine/pixel_colour.glsl"
layout(location = 0) out uvec4 words;
void main() {
    ivec2 pixel;
    uvec4 channels;
    vec3 weights;
    bool present = take(pixel, channels, weights);
    words = present ? uvec4(marked(colour_of(channels.rgb)), 0u, 0u) : uvec4(0u);
}
