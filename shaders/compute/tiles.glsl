// Tiles: triangles of the mesh, each with a surface map for every one of its three vertices.
#include "compute/tables.glsl"
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
uniform int tile_count;
uint word_of_tile(uint tile, int what) { return at_table(TABLE_TILES, tile * TILE_WORDS + uint(what)); }
uint of_tile(int what) { return word_of_tile(group_index(), what); }
