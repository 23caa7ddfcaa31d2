// One element of the vectors of a fit, with the numbers of its problem: for texts that update vectors, shared by GLSL and
// C++. An element holds what is side by side: three problems' entries or three of one problem's in GLSL, lanes in C++.
// element arithmetic is entry by entry; where(c, a, b) is a where c is not zero, else b.
#define MOST_VECTORS 8
#define MOST_REGISTERS 4
#define MOST_CONSTANTS 4

struct Elements {
    element x[MOST_VECTORS];  // the first of them are written
};
struct Registers {
    element x[MOST_REGISTERS];
};
struct Constants {
    real x[MOST_CONSTANTS];  // the same for all problems
};
