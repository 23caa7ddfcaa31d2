// The pixel of an image that a texel takes. GRID: the one at the texel's own place. ITEMS: by items that hold the colours,
// one layer an image; vertex stage: reflect/tiles.vert. Else: by items alone; distribute/tile.vert.
#include "distribute/tiles.glsl"
#include "combine/pixel_colour.glsl"
#if defined(GRID) || defined(ITEMS)
struct Pixel {
    uvec2 colour;
    bool present;
};
vec3 channels_of(Pixel pixel) { return channels_of(pixel.colour); }
#else
layout(location = 56) uniform int widen;  // 257 for 8-bit images, else 1
struct Pixel {
    uvec4 taken;
    bool present;
};
vec3 channels_of(Pixel pixel) { return vec3(ivec3(pixel.taken.rgb) * widen); }
#endif
#if defined(GRID)
layout(binding = 1) uniform usamplerBuffer images[BATCH];  // words of colour, and the mask in what b leaves
layout(location = 5) uniform int layout_width;
Pixel take_pixel(int image, ivec2 place, Site site) {
    int at = place.y * layout_width + place.x;
#if COLOUR == 8
    uvec2 colour = uvec2(texelFetch(images[image], at).r, 0u);
#else
    uvec2 colour = uvec2(texelFetch(images[image], 2 * at).r, texelFetch(images[image], 2 * at + 1).r);
#endif
    bool masked_in = COLOUR == 8 ? colour.r >= 1u << 24 : colour.g >= 1u << 16;
    return Pixel(colour, masked_in && site.usable);
}
#elif defined(ITEMS)
#include "combine/take_item.glsl"
layout(location = 0) flat in ivec3 frame;
layout(location = 1) flat in vec3 projected[3 * BATCH];
Pixel take_pixel(int image, ivec2 place, Site site) {
    Pixel pixel;
    vec3 weights = cell_barycentric((place - frame.xy) * frame.z);
    pixel.present = take_item(image, projected[3 * image], projected[3 * image + 1], projected[3 * image + 2], weights,
                              place, pixel.colour);
    return pixel;
}
#else
#include "distribute/take.glsl"
Pixel take_pixel(int only, ivec2 place, Site site) {
    Pixel pixel;
    ivec2 at;
    vec3 weights;
    pixel.present = take(at, pixel.taken, weights);
    return pixel;
}
#endif
