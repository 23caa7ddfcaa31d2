// What the shared texts of optimizers are written in, as GLSL has it: numbers of a problem are floats, an element is a
// vec3. C++: optim/methods.h.
#include "model/vec3_element.glsl"
#include "optimize/problem_state.glsl"
#include "optimize/elements.glsl"
