// What is known of a vertex, and summed over its samples, penalties included.
#define OF_DENSITY 0  // 1 / S-bar, ring texels, samples
#define OF_LAMBDA_VIEW 1
#define OF_ERROR 2
#define OF_LINE 3  // four sums along d
#define OF_VERTEX 7
#define TILE_SUMS 4  // of a tile and corner: E or the targets; along d four
