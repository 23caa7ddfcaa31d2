// A work group is a tile: the samples of a triangle, each of which counts for the problems of its three vertices. Each is
// there twice (compute/sample_store.h): by group, which is what the tile takes from one image, and by texel. Work items are in
// blocks of LANES, those with most samples first, and the samples of a block lie row by row, one of each item in a row.
#include "compute/tiles.glsl"
#include "compute/sample_words.glsl"
#include "model/loss.glsl"
#include "model/lfm.glsl"
uniform usamplerBuffer samples_by_group;  // the place is a texel of the tile
uniform usamplerBuffer samples_by_texel;  // the place is a group of the tile
uniform usamplerBuffer groups;            // [group]: samples; pairs of the three vertices with the image
uniform samplerBuffer target_weights;     // [side][texel]: Lambda of the three corners times the targets' scale
uniform samplerBuffer pair_values;        // [pair][term] h_k; alpha: root of the samples' weight
uniform samplerBuffer maps;               // x; or p, along d

// Where the first of an item's samples lies, and how far it is to the next.
struct Column {
    uint first, stride;
};
Column column_of(uint block, uint item, uint items) {
    uint begin = item - item % uint(LANES);
    return Column(at_table(TABLE_BLOCKS, block + item / uint(LANES)) + item - begin, min(uint(LANES), items - begin));
}

// Which of the tile's corners have a problem that runs.
bvec3 running_corners() {
    return bvec3(is_active(of_tile(TILE_VERTEX)), is_active(of_tile(TILE_VERTEX + 1)), is_active(of_tile(TILE_VERTEX + 2)));
}
