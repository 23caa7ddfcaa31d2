// ProblemState of each texel in two RGBA layers, and what its updates read.
#include "model/prelude.glsl"
#include "optimize/problem_state.glsl"
layout(binding = 9) uniform sampler2DArray state;
layout(binding = 10) uniform sampler2D lengths;    // alpha
layout(binding = 12) uniform sampler2D density;    // 1 / S-bar
layout(binding = 13) uniform sampler2D penalties;  // mu E_b, or its second derivative along d

ProblemState read_state(ivec2 at) {
    vec4 first = texelFetch(state, ivec3(at, 0), 0), second = texelFetch(state, ivec3(at, 1), 0);
    return ProblemState(first.r, first.g, first.b, first.a, second.r, second.g, second.b, second.a);
}
