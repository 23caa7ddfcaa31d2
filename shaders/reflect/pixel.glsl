// The pixel of an image that a texel takes, in 16-bit units. GRID: the one at the texel's own place. ITEMS: by items that
// hold the colours, one layer an image; vertex stage: reflect/tiles.vert. Else: by items alone; distribute/tile.vert.
#include "distribute/tiles.glsl"
layout(location = 56) uniform int widen;  // 257 for 8-bit images, else 1
#if defined(GRID)
layout(binding = 1) uniform usampler2D images[BATCH];
bool take_pixel(int image, ivec2 place, Site site, out vec3 channels) {
    uvec4 pixel = texelFetch(images[image], place, 0);
    channels = vec3(pixel.rgb * uint(widen));
    return pixel.a != 0u && site.usable;
}
#elif defined(ITEMS)
#include "combine/take_item.glsl"
layout(location = 0) flat in ivec3 frame;
layout(location = 1) flat in vec3 projected[3 * BATCH];
bool take_pixel(int image, ivec2 place, Site site, out vec3 channels) {
    uvec2 colour;
    vec3 weights = cell_barycentric((place - frame.xy) * frame.z);
    bool present = take_item(image, projected[3 * image], projected[3 * image + 1], projected[3 * image + 2], weights,
                             place, colour);
    channels = target_of(image, colour);  // pictures[image].z is 1
    return present;
}
#else
#include "distribute/take.glsl"
bool take_pixel(int only, ivec2 place, Site site, out vec3 channels) {
    ivec2 pixel;
    uvec4 taken;
    vec3 weights;
    bool present = take(pixel, taken, weights);
    channels = vec3(taken.rgb * uint(widen));
    return present;
}
#endif
