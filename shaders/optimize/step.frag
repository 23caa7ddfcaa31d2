#version 450 core
// variants: PROBLEMS=vertices,texels STEP=* OWN_LAYERS=0,2 ONLY=-,2
// variants: PROBLEMS=vertices STEP=* OWN_LAYERS=0 LEFT_OUT=63 FIRST_STEP=0.5
// One step of an optimizer, for every problem by itself: reads and writes its numbers only, all layers of them or one.
// LEFT_OUT, FIRST_STEP: of Turn; constants, for they are 0 but in experiments.
#include "optimize/dialect.glsl"
#include "optimize/numbers.glsl"
#include "optimize/PROBLEMS.glsl"
#include "optimize/TEXT.glsl"
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
#define RESULTS (3 + OWN_LAYERS)
#include "common/output.glsl"
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 a = texelFetch(state, ivec3(at, 0), 0), b = texelFetch(state, ivec3(at, 1), 0),
         c = texelFetch(state, ivec3(at, 2), 0);
    ProblemState s = ProblemState(a.r, a.g, a.b, a.a, b.r, b.g, b.b, b.a, c.r, c.g);
    Own own;
    for (int i = 0; i < MOST_OWN; ++i)
        own.x[i] = i < 4 * OWN_LAYERS ? texelFetch(state, ivec3(at, 3 + i / 4), 0)[i % 4] : 0.0;
    STEP(s, own, given_of(at), Turn(rule, restart, slot, StopRules(stop.x, stop.y), LEFT_OUT, FIRST_STEP));
    vec4 numbers[RESULTS];
    numbers[0] = vec4(s.error, s.norm, s.slope, s.step_factor);
    numbers[1] = vec4(s.beta, s.accepted, s.status, s.iterations);
    numbers[2] = vec4(s.alpha, s.taken, 0.0, 0.0);
#if OWN_LAYERS > 0
    for (int i = 0; i < OWN_LAYERS; ++i)
        numbers[3 + i] = vec4(own.x[4 * i], own.x[4 * i + 1], own.x[4 * i + 2], own.x[4 * i + 3]);
#endif
    WRITE(numbers);
}
