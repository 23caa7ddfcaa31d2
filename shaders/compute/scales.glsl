// Scales of sums in fixed point, of each vertex three side by side for its problems.
#define SCALE_SURFACE 0  // gradients
#define SCALE_VIEW 1
#define SCALE_ERROR 2
#define SCALE_SURFACE_SQUARES 3  // diag(J'J)
#define SCALE_VIEW_SQUARES 4
#define SCALE_LINE 5  // four sums along d
#define SCALES 9
