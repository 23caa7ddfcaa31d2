#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_FIRST_OWN=10 PROBLEMS=vertices_given,texels_given STEP=*
// One step of an optimizer, for every problem by itself: reads and writes its numbers only.
#include "optimize/dialect.glsl"
#include "optimize/TEXT.glsl"
layout(local_size_x = LANES) in;
layout(std430) buffer Numbers { float numbers[]; };
#ifndef LEFT_OUT
#define LEFT_OUT 0
#endif
#ifndef FIRST_STEP
#define FIRST_STEP 0.0
#endif
uniform int rule;
uniform int restart;
uniform vec2 stop;  // residual, output change
uniform int slot;
uniform int problem_count;
uniform int product_count;
#include "compute/PROBLEMS.glsl"

void main() {
    uint problem = (gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * uint(LANES) + gl_LocalInvocationID.x;
    if (problem >= uint(problem_count)) return;
    uint at = problem * uint(NUMBER_COUNT);
    ProblemState s = ProblemState(numbers[at], numbers[at + 1u], numbers[at + 2u], numbers[at + 3u], numbers[at + 4u],
                                  numbers[at + 5u], numbers[at + 6u], numbers[at + 7u], numbers[at + 8u],
                                  numbers[at + 9u]);
    if (s.status != STATUS_ACTIVE && s.accepted == 0.0) return;
    Own own;
    for (uint i = 0u; i < uint(MOST_OWN); ++i) own.x[i] = numbers[at + uint(NUMBER_FIRST_OWN) + i];
    STEP(s, own, given_of(problem), Turn(rule, restart, slot, StopRules(stop.x, stop.y), LEFT_OUT, FIRST_STEP));
    numbers[at] = s.error;
    numbers[at + 1u] = s.norm;
    numbers[at + 2u] = s.slope;
    numbers[at + 3u] = s.step_factor;
    numbers[at + 4u] = s.beta;
    numbers[at + 5u] = s.accepted;
    numbers[at + 6u] = s.status;
    numbers[at + 7u] = s.iterations;
    numbers[at + 8u] = s.alpha;
    numbers[at + 9u] = s.taken;
    for (uint i = 0u; i < uint(MOST_OWN); ++i) numbers[at + uint(NUMBER_FIRST_OWN) + i] = own.x[i];
}
