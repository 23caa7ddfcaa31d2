// Lets one text be GLSL and C++ (C++ side: src/core/model/prelude.h). Model text uses only real, real2, real3, real4, int,
// INOUT(T), SELECT(c, a, b), real(1.0) literals and the functions below; it is branch-free.
#define real float
#define real2 vec2
#define real3 vec3
#define real4 vec4
#define INOUT(T) inout T
#define SELECT(c, a, b) ((c) ? (a) : (b))
#define SHARED_FN
