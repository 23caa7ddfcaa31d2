// What the shared texts of optimizers are written in, as GLSL has it: numbers of a problem are floats, an element is a
// vec3. C++: optim/methods.h.
#include "model/prelude.glsl"
#include "optimize/problem_state.glsl"
#define element vec3
vec3 where(vec3 condition, vec3 a, vec3 b) { return mix(b, a, notEqual(condition, vec3(0.0))); }
#include "optimize/elements.glsl"
