// The samples of a light field map on the device, in two orders (compute/sample_store.h): by tile and image, for what a
// camera's view of a vertex adds up; by tile and texel, for what a texel does.
uniform usamplerBuffer pairs;  // of camera and vertex, [2]: weights of a look-up; its texel, image, root of the samples' weight
#ifdef WIDE
#define WORD uvec2
#define WORD_PART rg
vec3 colour_of(uvec2 word) { return vec3(uvec3(word.x & 0xffffu, word.x >> 16, word.y & 0xffffu)); }
uint place_of(uvec2 word) { return word.y >> 16; }
#else
#define WORD uint
#define WORD_PART r
vec3 colour_of(uint word) { return vec3((uvec3(word) >> uvec3(0u, 8u, 16u)) & 255u) * 257.0; }
uint place_of(uint word) { return word >> 24; }
#endif
uniform usamplerBuffer samples_by_image;  // the place is a texel of the tile
uniform usamplerBuffer samples_by_texel;  // the place is a group of the tile
WORD sample_at(usamplerBuffer samples, uint i) { return texelFetch(samples, int(i)).WORD_PART; }

// Of a surface map, which is that of a corner of a triangle.
#define MAP_FIRST 0        // element
#define MAP_GROUP 1        // its tile's first in TABLE_GROUP_FIRST
#define MAP_TEXEL 2        // likewise in TABLE_TEXEL_FIRST
#define MAP_GROUP_PAIR 3   // in TABLE_PAIRS_OF_GROUPS
#define MAP_IMAGE_GROUP 4  // in TABLE_GROUPS_OF_IMAGES
#define MAP_WEIGHT 5       // in TABLE_TARGET_WEIGHTS
#define MAP_NEIGHBOUR 6    // in TABLE_NEIGHBOURS
#define MAP_WORDS 7u
uint of_map(uint map, int what) { return at_table(TABLE_MAPS, map * MAP_WORDS + uint(what)); }
float target_weight(uint map, uint local) {
    return uintBitsToFloat(at_table(TABLE_TARGET_WEIGHTS, of_map(map, MAP_WEIGHT) + local));
}
