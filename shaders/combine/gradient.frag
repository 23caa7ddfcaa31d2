#version 450 core
// The surface gradient of a further term, from colours in SLS, for all corners. DIAGONAL: h_k^2 where a sample is.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#include "combine/target_of.glsl"
#include "combine/value_of.glsl"
layout(binding = 2) uniform MAPS surface;
#include "combine/residual3.glsl"
layout(binding = 4) uniform usampler2D colours;
layout(location = 10) uniform int term;
layout(location = 3) flat in ivec3 frame;
layout(location = 0) out vec4 gradient[3];
void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    uvec4 taken = texelFetch(colours, place, 0);
    vec3 target = target_of(taken.rgb);
    vec3 weights = cell_barycentric((place - frame.xy) * frame.z);
    for (int corner = 0; corner < 3; ++corner) {
        vec3 h = value_of(corner, term);
#ifdef DIAGONAL
        vec3 slope = h * h;
#else
        vec3 slope = lfm_gradient_surface(residual_of(corner, target, weights, place), h);
#endif
        gradient[corner] = taken.a != 0u ? vec4(slope, 0.0) : vec4(0.0);
    }
}
