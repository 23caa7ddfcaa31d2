#version 450 core
// One pass into SLS for one image: residuals of all three corners, and the surface gradient of the first term, blended.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "distribute/take.glsl"
#include "gather/maps.glsl"
#include "combine/values3.glsl"

layout(location = 5) flat in vec3 value[VALUES];
#ifdef VALUES_FETCHED
layout(binding = 5) uniform sampler2DArray view_values;
vec3 value_of(int corner, int k) { return texelFetch(view_values, ivec3(ivec2(value[corner].xy), k), 0).rgb; }
#else
vec3 value_of(int corner, int k) { return value[corner * TERMS + k]; }
#endif
layout(binding = 2) uniform MAPS surface;
layout(location = 11) uniform float target_scale;  // per unit of a 16-bit channel
layout(location = 12) uniform int widen;           // 257 for 8-bit images, else 1
layout(location = 0) out vec4 residual[3];
layout(location = 3) out vec4 gradient[3];

void main() {
    ivec2 pixel;
    uvec4 channels;
    vec3 weights;
    bool present = take(pixel, channels, weights);
    vec3 t = vec3(channels.rgb * uint(widen));
    ivec2 place = ivec2(gl_FragCoord.xy);
    for (int corner = 0; corner < 3; ++corner) {
        vec3 r = -(weights[corner] * target_scale) * t;
        for (int k = 0; k < TERMS; ++k)
            r += lfm_value(load(texelFetch(surface, ivec3(place, corner * TERMS + k), 0)), value_of(corner, k));
        r = present ? r : vec3(0.0);
        residual[corner] = vec4(r, present ? 1.0 : 0.0);
        gradient[corner] = vec4(lfm_gradient_surface(r, value_of(corner, 0)), 0.0);
    }
}
