#version 450 core
// The step length of every problem after pass B.
#include "optimize/state.glsl"
layout(location = 20) uniform int rule;
layout(location = 22) uniform vec2 stop;  // residual, output change
layout(location = 0) out vec4 status;
layout(location = 1) out vec4 alpha;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 constant = texelFetch(constants, ivec3(at, 0), 0);
    vec4 old_alpha = texelFetch(steps, at, 0);
    status = vec4(0.0);
    alpha = vec4(0.0);
    for (int c = 0; c < 3; ++c) {
        ProblemState s = read_state(at, c);
        float penalty = sum_over_maps(9, at, c);
        LineSums q = LineSums(constant.r * sum_over_samples(1, at, c) + penalty,
                              constant.r * sum_over_samples(2, at, c) + penalty,
                              constant.r * sum_over_samples(3, at, c), constant.r * sum_over_samples(4, at, c));
        float step = old_alpha[c];
        after_line(s, step, rule, constant.g, StopRules(stop.x, stop.y), q);
        status[c] = s.status;
        alpha[c] = step;
    }
}
