#version 450 core
// The surface gradient of a further term, from residuals in SLS, for all corners. DIAGONAL: h_k^2 where a sample is.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "gather/maps.glsl"
#ifndef ONE_TERM
#define ONE_TERM
#endif
#include "combine/values3.glsl"
layout(location = 5) flat in vec3 value[VALUES];
layout(binding = 4) uniform sampler2DArray residuals;
layout(location = 0) out vec4 gradient[3];
void main() {
    for (int corner = 0; corner < 3; ++corner) {
        vec4 sample_at = texelFetch(residuals, ivec3(ivec2(gl_FragCoord.xy), corner), 0);
#ifdef DIAGONAL
        gradient[corner] = vec4(sample_at.a * value[corner] * value[corner], 0.0);
#else
        gradient[corner] = vec4(lfm_gradient_surface(sample_at.rgb, value[corner]), 0.0);
#endif
    }
}
