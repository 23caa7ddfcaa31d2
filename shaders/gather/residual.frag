#version 450 core
// variants: WEIGHTED=-,1 VALUES=0,2 CACHED=-,1
// Convert-R-To-SLS (Section 5.1.1) for one corner: residuals of the pixels that texels take; alpha 1 where one is.
// TARGET_ONLY: the target L t itself, to count samples and find its mean. WEIGHTED: residuals times the root of their weight.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "distribute/tiles.glsl"
#ifdef CACHED
#include "distribute/taken.glsl"
#else
#include "distribute/take.glsl"
#endif
#include "gather/maps.glsl"
#include "gather/view_values.glsl"

uniform MAPS surface_maps;
uniform int corner;
uniform float target_scale;  // per unit of a 16-bit channel
uniform int to_16_bit;  // factor: 257 for 8-bit images, else 1
layout(location = 0) out vec4 residual;

void main() {
    ivec2 pixel;
    uvec4 channels;
    vec3 weights;
    bool present = take(pixel, channels, weights);
    float weight = corner == 0 ? weights.x : corner == 1 ? weights.y : weights.z;
    vec3 target = (weight * target_scale) * vec3(channels.rgb * uint(to_16_bit));
#ifdef TARGET_ONLY
    vec3 r = target;
#else
#ifdef WEIGHTED
    target *= texelFetch(view_values, ivec3(problem, 0), 0).a;
#endif
    vec3 r = -target;
    ivec2 place = ivec2(gl_FragCoord.xy);
    for (int k = 0; k < TERMS; ++k)
        r += lfm_value(load(texelFetch(surface_maps, ivec3(place, corner * TERMS + k), 0)), view_value(k));
#endif
    residual = present ? vec4(r, 1.0) : vec4(0.0);
}
