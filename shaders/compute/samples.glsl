// A work group is a tile: the samples of a triangle, each of which counts for the problems of its three vertices. They stand
// twice (compute/sample_store.h): by group, which is what the tile takes from one image, and by texel. Work items are in
// blocks of LANES, those with most samples first, and the samples of a block lie row by row, one of each item in a row.
#include "compute/tables.glsl"
#include "model/loss.glsl"
#include "model/lfm.glsl"
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
uniform usamplerBuffer samples_by_group;  // the place is a texel of the tile
uniform usamplerBuffer samples_by_texel;  // the place is a group of the tile
uniform usamplerBuffer groups;            // [group]: samples; pairs of the three vertices with the image
uniform samplerBuffer target_weights;     // [side][texel]: Lambda of the three corners times the targets' scale
uniform samplerBuffer pair_values;        // [pair][term] h_k; alpha: root of the samples' weight
uniform samplerBuffer maps;               // x; or p, along d

#define TILE_VERTEX 0      // 3 vertices
#define TILE_MAP 3         // 3 first elements of surface maps
#define TILE_GROUP 6       // first group
#define TILE_GROUPS 7      // how many
#define TILE_TEXEL 8       // first in TABLE_TEXELS
#define TILE_TEXELS 9      // how many, with or without samples
#define TILE_WEIGHT 10     // in target_weights
#define TILE_GROUP_BLOCK 11  // first in TABLE_BLOCKS
#define TILE_TEXEL_BLOCK 12
#define TILE_WORDS 13u
uint of_tile(int what) { return at_table(TABLE_TILES, group_index() * TILE_WORDS + uint(what)); }
uniform int tile_count;

// Where the first of an item's samples lies, and how far it is to the next.
struct Column {
    uint first, stride;
};
Column column_of(uint block, uint item, uint items) {
    uint begin = item - item % uint(LANES);
    return Column(at_table(TABLE_BLOCKS, block + item / uint(LANES)) + item - begin, min(uint(LANES), items - begin));
}
WORD sample_at(usamplerBuffer samples, uint i) { return texelFetch(samples, int(i)).WORD_PART; }

// Which of the tile's corners have a problem that runs.
bool[3] running_corners() {
    bool running[3];
    for (int c = 0; c < 3; ++c) running[c] = is_active(of_tile(TILE_VERTEX + c));
    return running;
}
