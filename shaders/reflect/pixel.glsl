// The pixel that a texel takes of an image, where it lies being a PLACE. GRID: at the texel's own place, in a stack of
// images (C++: fragment/image_stack.h). Else in a layer where reflect/take.frag left it; but where a pass has one image alone,
// by that image's items.
#include "reflect/sample.glsl"
#include "combine/pixel_colour.glsl"

struct Pixel {
    vec3 channels;  // in 16-bit units
    bool present;
};
Pixel pixel_of(uvec2 words) { return Pixel(channels_of(words), is_marked(words)); }

#if defined(GRID)
uniform usamplerBuffer images;  // words of colour, and the mask in what b leaves
uniform int blocks_per_row;  // of 4 x 4 pixels
uniform int images_per_block;
#define PLACE int
const int next_image = 16;
int in_first_image(ivec2 place) {
    ivec2 block = place >> 2, inside = place & 3;
    return (block.y * blocks_per_row + block.x) * (images_per_block * 16) + inside.y * 4 + inside.x;
}
Pixel take_pixel(int at) { return pixel_of(texelFetch(images, at).rg); }
#elif defined(ONE_IMAGE)
#include "distribute/take.glsl"
uniform int to_16_bit;  // factor: 257 for 8-bit images, else 1
#define PLACE ivec2
ivec2 in_first_image(ivec2 place) { return place; }
Pixel take_pixel(ivec2 place) {
    ivec2 at;
    uvec4 channels;
    vec3 weights;
    bool present = take(at, channels, weights);
    return Pixel(vec3(ivec3(channels.rgb) * to_16_bit), present);
}
#else
uniform usampler2DArray taken;
#define PLACE ivec3
const ivec3 next_image = ivec3(0, 0, 1);
ivec3 in_first_image(ivec2 place) { return ivec3(place, 0); }
Pixel take_pixel(ivec3 at) { return pixel_of(texelFetch(taken, at, 0).rg); }
#endif

Sample observe(View view, Site site, Pixel pixel) {
    Sample s = sample_of(view, site, pixel.channels);
    s.counts = s.counts && pixel.present && site.usable;
    return s;
}

vec3 residual_of(Parameters p, Basis b, Sample s) { return s.counts ? value_of(p, b) - s.target : vec3(0.0); }
