#version 450 core
// One pass into SLS for one image: the target that each texel takes, alpha 1 where there is one, and the surface
// gradient of the first term for all three corners, blended.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "distribute/take.glsl"
#include "gather/maps.glsl"
#include "combine/value_of.glsl"
layout(binding = 2) uniform MAPS surface;
#include "combine/residual3.glsl"
layout(location = 11) uniform float target_scale;  // per unit of a 16-bit channel
layout(location = 12) uniform int widen;           // 257 for 8-bit images, else 1
layout(location = 0) out vec4 taken;
layout(location = 1) out vec4 gradient[3];

void main() {
    ivec2 pixel;
    uvec4 channels;
    vec3 weights;
    bool present = take(pixel, channels, weights);
    vec3 target = target_scale * vec3(channels.rgb * uint(widen));
    taken = present ? vec4(target, 1.0) : vec4(0.0);
    for (int corner = 0; corner < 3; ++corner) {
        vec3 r = residual_of(corner, target, weights, ivec2(gl_FragCoord.xy));
        gradient[corner] = present ? vec4(lfm_gradient_surface(r, value_of(corner, 0)), 0.0) : vec4(0.0);
    }
}
