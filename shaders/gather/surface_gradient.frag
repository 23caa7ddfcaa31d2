#version 450 core
// variants: LOSS=* DIAGONAL=-,1 STORAGE=0,1 VALUES=0,1
// Top of Figure 5: dE/dg_k = r h_k, blended into the corner's gradient. DIAGONAL: its square for diag(J'J), h_k^2.
#include "model/prelude.glsl"
#define element vec3
#include "model/loss.glsl"
#include "model/lfm.glsl"
#include "gather/maps.glsl"
#include "gather/view_values.glsl"

uniform sampler2DArray residuals;
uniform int corner;
#if VALUES > 0
const int term = 0;  // map.vert has looked up the one that is wanted
#else
uniform int term;
#endif
layout(location = 0) out vec4 gradient;

void main() {
    vec4 sample_at = texelFetch(residuals, ivec3(ivec2(gl_FragCoord.xy), corner), 0);
    vec3 r = sample_at.rgb, h = view_value(term);
#ifdef DIAGONAL
    gradient = vec4(LOSS_WEIGHTED(r * r, sample_at.a * h * h), 0.0);
#else
    gradient = vec4(lfm_gradient_surface(LOSS_WEIGHTED(r * r, r), h), 0.0);
#endif
}
