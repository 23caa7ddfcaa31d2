// An element of shared texts is three numbers side by side.
#include "model/prelude.glsl"
#define element vec3
vec3 where(vec3 condition, vec3 a, vec3 b) { return mix(b, a, notEqual(condition, vec3(0.0))); }
