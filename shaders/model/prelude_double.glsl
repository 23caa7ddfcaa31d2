// The dialect of model/prelude.glsl in double precision.
#define real double
#define real2 dvec2
#define real3 dvec3
#define real4 dvec4
#define INOUT(T) inout T
#define SELECT(c, a, b) ((c) ? (a) : (b))
#define SHARED_FN
