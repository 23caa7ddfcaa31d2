// Colours that texels take in the images of a batch, kept in one RGBA32UI texel: a component per image where channels
// have COLOUR = 8 bits, two where they have 16; the bit above the colour says that there is one.
#include "combine/cameras.glsl"
#include "combine/pixel_colour.glsl"

vec3 target_of(int image, uvec2 colour) { return pictures[image].z * channels_of(colour); }

struct Colours {
    uint part[4];
};

void keep(inout Colours colours, int image, bool present, uvec2 colour) {
#if COLOUR == 8
    colours.part[image] = present ? colour.x | 1u << 24 : 0u;
#else
    colours.part[2 * image] = present ? colour.x : 0u;
    colours.part[2 * image + 1] = present ? colour.y | 1u << 16 : 0u;
#endif
}

bool kept(uvec4 colours, int image, out uvec2 colour) {
#if COLOUR == 8
    colour = uvec2(colours[image], 0u);
    return colour.x >= 1u << 24;
#else
    colour = uvec2(colours[2 * image], colours[2 * image + 1]);
    return colour.y >= 1u << 16;
#endif
}
