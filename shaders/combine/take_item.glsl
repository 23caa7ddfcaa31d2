// The pixel that a texel takes and its colour in one look-up: items made with COLOUR.
#include "combine/target_of.glsl"
layout(binding = 0) uniform usampler2D items;
layout(location = 5) uniform int layout_width;

// q0, q1, q2: the triangle's vertices in homogeneous pixel coordinates; size: of the image, pixels.
bool take_item(vec3 q0, vec3 q1, vec3 q2, vec3 weights, ivec2 place, vec2 size, out uvec3 channels) {
    precise vec3 q = weights.x * q0 + weights.y * q1 + weights.z * q2;
    precise vec2 at = floor(q.xy / q.z);
    bool inside = all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, size));
    uvec4 item = texelFetch(items, inside ? ivec2(at) : ivec2(0), 0);
#if COLOUR == 8
    channels = uvec3(item.g & 255u, item.g >> 8 & 255u, item.g >> 16);
#else
    channels = uvec3(item.g & 65535u, item.g >> 16, item.b);
#endif
    return inside && item.r == uint(place.y * layout_width + place.x);
}
