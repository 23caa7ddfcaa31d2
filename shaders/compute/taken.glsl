// Which texel a pixel is a sample of: that whose item the pixel holds, if the texel's own centre projects to the pixel.
// The same texels take the same pixels as by distribute/take.glsl.
#include "distribute/camera.glsl"
#include "distribute/tiles.glsl"
uniform usampler2D items;         // with colours, as distribute/item.frag writes them
uniform samplerBuffer positions;  // [vertex][4]: position, and its frame
uniform int colour_bits;          // of a channel: 8 or 16
#define NO_ITEM 0xffffffffu

vec3 corner_of(uint vertex) { return project(texelFetch(positions, 4 * int(vertex)).xyz); }
// The pixel that a cell's centre projects to; corners: homogeneous pixel coordinates of the tile's vertices.
vec2 pixel_of(vec3 weights, vec3 corner0, vec3 corner1, vec3 corner2) {
    precise vec3 q = weights.x * corner0 + weights.y * corner1 + weights.z * corner2;
    precise vec2 at = floor(q.xy / q.z);
    return at;
}
// The colour in an item, in 16-bit units of a channel.
vec3 colour_in(uvec4 item) {
    return colour_bits == 8 ? vec3((uvec3(item.y) >> uvec3(0u, 8u, 16u)) & 255u) * 257.0
                            : vec3(uvec3(item.y & 0xffffu, item.y >> 16, item.z));
}
uint local_of(ivec2 cell) { return uint(cell.y * SIDE - cell.y * (cell.y - 1) / 2 + cell.x); }
