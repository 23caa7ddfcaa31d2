// Colours that texels take in the images of a batch, kept in one RGBA32UI texel: a component per image where channels
// have COLOUR = 8 bits, two where they have 16; the bit above the colour says that there is one.
#include "combine/cameras.glsl"
#include "combine/pixel_colour.glsl"

vec3 target_of(int image, uvec2 colour) { return image_extents[image].z * channels_of(colour); }

struct Colours {
    uint part[4];
};

void keep(inout Colours colours, int image, bool present, uvec2 colour) {
#if COLOUR == 8
    colours.part[image] = present ? marked(colour).x : 0u;
#else
    colour = present ? marked(colour) : uvec2(0u);
    colours.part[2 * image] = colour.x;
    colours.part[2 * image + 1] = colour.y;
#endif
}

bool kept(uvec4 colours, int image, out uvec2 colour) {
#if COLOUR == 8
    colour = uvec2(colours[image], 0u);
#else
    colour = uvec2(colours[2 * image], colours[2 * image + 1]);
#endif
    return is_marked(colour);
}
