// A pixel's colour in whole words, COLOUR bits a channel: 8 bits (r | g << 8 | b << 16, nothing), 16 bits (r | g << 16, b);
// above b a bit may say that there is one.
#ifndef COLOUR
#define COLOUR 8
#endif

// The channels of a colour in 16-bit units.
vec3 channels_of(uvec2 colour) {
#if COLOUR == 8
    return vec3(ivec3(uvec3(colour.x, colour.x >> 8, colour.x >> 16) & 255u) * 257);
#else
    return vec3(ivec3(colour.x & 65535u, colour.x >> 16, colour.y & 65535u));
#endif
}

uvec2 colour_of(uvec3 channels) {
#if COLOUR == 8
    return uvec2(channels.r | channels.g << 8 | channels.b << 16, 0u);
#else
    return uvec2(channels.r | channels.g << 16, channels.b);
#endif
}

uvec2 marked(uvec2 colour) { return COLOUR == 8 ? uvec2(colour.x | 1u << 24, 0u) : uvec2(colour.x, colour.y | 1u << 16); }
bool is_marked(uvec2 colour) { return COLOUR == 8 ? colour.x >= 1u << 24 : colour.y >= 1u << 16; }
