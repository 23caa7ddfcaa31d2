#version 450 core
// The step length of every texel's problem after pass B.
#include "reflect/state.glsl"
#include "optimize/after_line.glsl"
layout(binding = 11) uniform sampler2DArray sums;  // over samples along d: of a^2, of a^2 + r b
layout(location = 20) uniform int rule;
layout(location = 22) uniform vec2 stop;  // residual, output change
layout(location = 0) out vec4 second_fields;
layout(location = 1) out vec4 alpha;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ProblemState s = read_state(at);
    vec2 sum = texelFetch(density, at, 0).r * texelFetch(sums, ivec3(at, 0), 0).rg + texelFetch(penalties, at, 0).r;
    float step = texelFetch(lengths, at, 0).r;
    after_line(s, step, rule, 1.0, StopRules(stop.x, stop.y), LineSums(sum.x, sum.y, 0.0, 0.0));
    second_fields = vec4(s.beta, s.accepted, s.status, s.iterations);
    alpha = vec4(step, 0.0, 0.0, 0.0);
}
