// The pixel that a texel takes and its colour in one look-up: items made with COLOUR, a layer per image.
#include "combine/colours.glsl"
uniform usampler2DArray items;

// q0, q1, q2: the triangle's vertices in homogeneous pixel coordinates.
bool take_item(int image, vec3 q0, vec3 q1, vec3 q2, vec3 weights, ivec2 place, out uvec2 colour) {
    precise vec3 q = weights.x * q0 + weights.y * q1 + weights.z * q2;
    precise vec2 at = floor(q.xy / q.z);
    bool inside = all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, image_extents[image].xy));
    uvec4 item = texelFetch(items, ivec3(inside ? ivec2(at) : ivec2(0), image), 0);
    colour = item.gb;
    return inside && item.r == uint(place.y * layout_width + place.x);
}
