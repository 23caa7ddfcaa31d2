// Fragment side of pass 2 of Section 5.1.1: the pixel that an SLS texel takes.
#include "distribute/tiles.glsl"

uniform usampler2D items;
uniform usampler2D image;
uniform vec2 image_size;  // pixels

layout(location = 0) flat in vec3 corner0;
layout(location = 1) flat in vec3 corner1;
layout(location = 2) flat in vec3 corner2;
layout(location = 3) flat in ivec3 frame;

// The pixel that the texel's own centre projects to, if that pixel's item is this texel and the mask holds it.
// channels: the pixel's, alpha being the mask; weights: barycentric at the texel's centre.
bool take(out ivec2 pixel, out uvec4 channels, out vec3 weights) {
    ivec2 place = ivec2(gl_FragCoord.xy);
    weights = cell_barycentric((place - frame.xy) * frame.z);
    precise vec3 q = weights.x * corner0 + weights.y * corner1 + weights.z * corner2;
    precise vec2 at = floor(q.xy / q.z);
    bool inside = all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, image_size));
    pixel = inside ? ivec2(at) : ivec2(0);
    uint item = texelFetch(items, pixel, 0).r;
    channels = texelFetch(image, pixel, 0);
    return inside && item == uint(place.y * layout_width + place.x) && channels.a != 0u;
}
