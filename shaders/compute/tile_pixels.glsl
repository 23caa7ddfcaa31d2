// A work group is a tile that an image may see: each of its texels looks for the pixel that it takes there, and the work
// group adds up what they bring, in one order.
#include "compute/tiles.glsl"
#include "compute/taken.glsl"
#include "model/loss.glsl"
#include "model/lfm.glsl"
uniform usamplerBuffer drawn_tiles;
uniform int drawn_count;
uniform float target_scale;         // per unit of a 16-bit channel
uniform samplerBuffer maps;         // x; or p, along d
uniform samplerBuffer pair_values;  // [vertex][term] h_k; alpha: root of the samples' weight
uint this_tile() { return texelFetch(drawn_tiles, int(group_index())).r; }

ivec2 cell_of(uint local) {
    const float rows = float(2 * SIDE + 1);
    int row = int(0.5 * (rows - sqrt(rows * rows - 8.0 * float(local))));
    row += int(local_of(ivec2(0, row + 1)) <= local) - int(local_of(ivec2(0, row)) > local);  // rounding
    return ivec2(local - local_of(ivec2(0, row)), row);
}
const uint texel_count = uint(SIDE * (SIDE + 1) / 2);

// The colour of the pixel that a texel takes; false if it takes none. corners: of corner_of(), of the tile's vertices.
bool take(ivec3 frame, ivec2 cell, vec3 weights, vec3 corners[3], out vec3 colour) {
    vec2 at = pixel_of(weights, corners[0], corners[1], corners[2]);
    bool inside = all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, image_size));
    uvec4 item = texelFetch(items, inside ? ivec2(at) : ivec2(0), 0);
    ivec2 place = frame.xy + frame.z * cell;
    colour = colour_in(item);
    return inside && item.x == uint(place.y * layout_width + place.x);
}

// Sums over the work group, ALL of them: each invocation shares its parts, and then any may ask for a sum, always in the
// same order. share() holds barriers: it is for all invocations.
shared vec4 all_parts[LANES * ALL];
void share(vec3 mine[ALL]) {
    barrier();  // whoever reads earlier parts has done so
    for (uint i = 0u; i < uint(ALL); ++i) all_parts[i * uint(LANES) + lane()] = vec4(mine[i], 0.0);
    barrier();
}
vec3 shared_sum(uint which) {
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < uint(LANES); ++i) sum += all_parts[which * uint(LANES) + i].xyz;
    return sum;
}
