#version 450 core
// What an iteration reports of all problems, BLOCK of them an invocation: how many run, of how many the trial was accepted, and
// the sum of their errors, two floats. Always in the same order.
// variants: LANES=32 BLOCK=256 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5
#include "optimize/dialect.glsl"
#include "optimize/error_sum.glsl"
layout(local_size_x = LANES) in;
layout(std430) readonly buffer Numbers { float numbers[]; };
uniform int problem_count;
layout(std430) buffer Summaries { uvec4 summaries[]; };
void main() {
    uint block = (gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * uint(LANES) + gl_LocalInvocationID.x;
    if (block * uint(BLOCK) >= uint(problem_count)) return;
    uint end = min((block + 1u) * uint(BLOCK), uint(problem_count));
    uvec2 counts = uvec2(0u);
    vec2 error = vec2(0.0);
    for (uint problem = block * uint(BLOCK); problem < end; ++problem) {
        uint at = problem * uint(NUMBER_COUNT);
        counts += uvec2(numbers[at + uint(NUMBER_STATUS)] == STATUS_ACTIVE, numbers[at + uint(NUMBER_ACCEPTED)] != 0.0);
        error = plus(error, vec2(finite_error(numbers[at]), 0.0));
    }
    summaries[block] = uvec4(counts, floatBitsToUint(error));
}
