#version 450 core
// The conditional update of every problem after pass A (Sections 5.2, 5.3).
#include "optimize/state.glsl"
layout(location = 20) uniform int rule;
layout(location = 21) uniform int restart;
layout(location = 22) uniform vec2 stop;  // residual, output change
layout(location = 0) out vec4 fields[8];
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 constant = texelFetch(constants, ivec3(at, 0), 0);
    vec4 result[8];
    for (int i = 0; i < 8; ++i) result[i] = vec4(0.0);
    for (int c = 0; c < 3; ++c) {
        ProblemState s = read_state(at, c);
        float trial_error = 0.5 * constant.r * sum_over_samples(0, at, c) + sum_over_maps(5, at, c);
        after_direction(s, rule, restart != 0, texelFetch(steps, at, 0)[c], constant.g, StopRules(stop.x, stop.y),
                        trial_error, sum_over_maps(6, at, c), sum_over_maps(7, at, c), sum_over_maps(8, at, c));
        result[0][c] = s.error;
        result[1][c] = s.norm;
        result[2][c] = s.slope;
        result[3][c] = s.step_factor;
        result[4][c] = s.beta;
        result[5][c] = s.accepted;
        result[6][c] = s.status;
        result[7][c] = s.iterations;
    }
    for (int i = 0; i < 8; ++i) fields[i] = result[i];
}
