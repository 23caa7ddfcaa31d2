#version 450 core
// variants: BATCH=1,2 TERMS=1,2,9 COLOUR=8,16 DIAGONAL=-,1
// variants: BATCH=2 TERMS=2 COLOUR=8 DIAGONAL=-,1 WEIGHTED=1
// The surface gradient of a further term, from colours in SLS, for all corners. DIAGONAL: h_k^2 where a sample is.
#include "model/prelude.glsl"
#define element vec3
#include "model/loss.glsl"
#include "model/lfm.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#include "combine/colours.glsl"
#include "combine/value_of.glsl"
#include "combine/residual3.glsl"
uniform MAPS surface_maps;
uniform usampler2D colours;
uniform int term;
layout(location = 0) flat in ivec3 frame;
layout(location = 0) out vec4 gradient[3];

#define ADD(image) add(image, taken, weights, g, sum)
void add(int image, uvec4 taken, vec3 weights, vec3 g[3 * TERMS], inout vec3 sum[3]) {
    uvec2 colour;
    bool present = kept(taken, image, colour);
    vec3 target = target_of(image, colour);
    for (int corner = 0; corner < 3; ++corner) {
        vec3 h = value_of(image, corner, term);
        vec3 r = residual_of(image, corner, target, weights, g);
#ifdef DIAGONAL
        vec3 slope = LOSS_WEIGHTED(r * r, h * h);
#else
        vec3 slope = lfm_gradient_surface(LOSS_WEIGHTED(r * r, r), h);
#endif
        sum[corner] += present ? slope : vec3(0.0);
    }
}

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    uvec4 taken = texelFetch(colours, place, 0);
    vec3 weights = cell_barycentric((place - frame.xy) * frame.z);
    vec3 g[3 * TERMS];
    for (int i = 0; i < 3 * TERMS; ++i) g[i] = load(texelFetch(surface_maps, ivec3(place, i), 0));
    vec3 sum[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
    FOR_EACH_IMAGE(ADD)
    for (int corner = 0; corner < 3; ++corner) gradient[corner] = vec4(sum[corner], 0.0);
}
