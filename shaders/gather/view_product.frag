#version 450 core
// Bottom of Figure 5, before the sum: r g_k of every texel of one corner. DIAGONAL: g_k^2 where a sample is.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "gather/maps.glsl"

layout(binding = 2) uniform MAPS surface;
layout(binding = 4) uniform sampler2DArray residuals;
layout(location = 8) uniform int corner;
layout(location = 10) uniform int term;
layout(location = 0) out vec4 product;

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    vec4 sample_at = texelFetch(residuals, ivec3(place, corner), 0);
    vec3 g = load(texelFetch(surface, ivec3(place, corner * TERMS + term), 0));
#ifdef DIAGONAL
    product = vec4(sample_at.a * g * g, 0.0);
#else
    product = vec4(lfm_gradient_view(sample_at.rgb, g), 0.0);
#endif
}
