#version 450 core
// The conditional update of every texel's problem after pass A (Sections 5.2, 5.3).
#include "reflect/state.glsl"
#include "optimize/after_direction.glsl"
layout(binding = 11) uniform sampler2DArray sums;  // over samples: of r^2 in the first layer's alpha
layout(binding = 14) uniform sampler2D products;   // z'.g', z'.g, d.g'
layout(location = 20) uniform int rule;
layout(location = 21) uniform int restart;
layout(location = 22) uniform vec2 stop;  // residual, output change
layout(location = 0) out vec4 fields[2];
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ProblemState s = read_state(at);
    vec3 product = texelFetch(products, at, 0).rgb;
    float trial_error =
        0.5 * texelFetch(density, at, 0).r * texelFetch(sums, ivec3(at, 0), 0).a + texelFetch(penalties, at, 0).r;
    after_direction(s, rule, restart != 0, texelFetch(lengths, at, 0).r, 1.0, StopRules(stop.x, stop.y), trial_error,
                    product.r, product.g, product.b);
    fields[0] = vec4(s.error, s.norm, s.slope, s.step_factor);
    fields[1] = vec4(s.beta, s.accepted, s.status, s.iterations);
}
