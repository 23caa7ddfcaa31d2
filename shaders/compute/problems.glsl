// What is known of a vertex, and summed over its samples; penalties included.
#define OF_DENSITY 0  // 1 / S-bar, ring texels
#define OF_LAMBDA_VIEW 1
#define OF_TARGETS 2  // sum of L t, and samples
#define OF_ERROR 3
#define OF_LINE 4  // four sums along d
#define OF_RESIDUALS 8  // sum of what residuals cost, twice
#define OF_VERTEX 9
