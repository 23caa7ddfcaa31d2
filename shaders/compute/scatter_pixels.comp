#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 ACCUMULATE=1,3 DIAGONAL=-,1 LOSS=*
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 ACCUMULATE=1,3 ALONG=1 QUARTIC=-,1 LOSS=*
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1 ACCUMULATE=1 TARGET_ONLY=1
// An image's pixels scatter, an invocation each. The number of a vertex is also that of its pair with the image.
#define WITH_CORNERS
#if !defined(ALONG) && !defined(TARGET_ONLY)
#define WITH_ELEMENTS
#define WITH_PAIRS
#endif
#include "compute/accumulate.glsl"
#include "compute/scatter.glsl"
#include "compute/taken.glsl"
uniform float target_scale;  // per unit of a 16-bit channel
void main() {
    uint i = group_index() * uint(LANES) + lane();
    uvec2 size = uvec2(image_size);
    if (i >= size.x * size.y) return;
    ivec2 pixel = ivec2(i % size.x, i / size.x);
    uvec4 item = texelFetch(items, pixel, 0);
    if (item.x == NO_ITEM) return;
    ivec3 cell = tile_at(ivec2(item.x % uint(layout_width), item.x / uint(layout_width)));
    uint tile = uint(cell.z);
    uvec3 vertices = uvec3(word_of_tile(tile, TILE_VERTEX), word_of_tile(tile, TILE_VERTEX + 1), word_of_tile(tile, TILE_VERTEX + 2));
    vec3 weights = cell_barycentric(cell.xy);
    if (pixel_of(weights, corner_of(vertices.x), corner_of(vertices.y), corner_of(vertices.z)) != vec2(pixel)) return;
    scatter(tile, local_of(cell.xy), weights * target_scale, colour_in(item), vertices);
}
