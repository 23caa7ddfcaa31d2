#version 450 core
// variants: BATCH=1,2,4 TERMS=1,2 COLOUR=8,16
// variants: BATCH=1,2 TERMS=1,9 COLOUR=8,16 WEIGHTED=1
// One pass into SLS for a batch of images: the colours that each texel takes, and the surface gradient of the first term
// for all three corners, summed over the batch and blended.
#include "model/prelude.glsl"
#define element vec3
#include "model/loss.glsl"
#include "model/lfm.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#include "combine/value_of.glsl"
#include "combine/take_item.glsl"
#include "combine/residual3.glsl"
uniform MAPS surface_maps;
layout(location = 0) flat in ivec3 frame;
layout(location = 1 + VALUES) flat in vec3 projected[3 * BATCH];  // as combine/map3.vert has it
layout(location = 0) out uvec4 taken;
layout(location = 1) out vec4 gradient[3];

#define ADD(image) add(image, place, weights, g, sum, colours)
void add(int image, ivec2 place, vec3 weights, vec3 g[3 * TERMS], inout vec3 sum[3], inout Colours colours) {
    uvec2 colour;
    bool present = take_item(image, projected[3 * image], projected[3 * image + 1], projected[3 * image + 2], weights,
                             place, colour);
    keep(colours, image, present, colour);
    vec3 target = target_of(image, colour);
    for (int corner = 0; corner < 3; ++corner) {
        vec3 r = residual_of(image, corner, target, weights, g);
        vec3 slope = lfm_gradient_surface(LOSS_WEIGHTED(r * r, r), value_of(image, corner, 0));
        sum[corner] += present ? slope : vec3(0.0);
    }
}

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    vec3 weights = cell_barycentric((place - frame.xy) * frame.z);
    vec3 g[3 * TERMS];
    for (int i = 0; i < 3 * TERMS; ++i) g[i] = load(texelFetch(surface_maps, ivec3(place, i), 0));
    vec3 sum[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
    Colours colours = Colours(uint[4](0u, 0u, 0u, 0u));
    FOR_EACH_IMAGE(ADD)
    taken = uvec4(colours.part[0], colours.part[1], colours.part[2], colours.part[3]);
    for (int corner = 0; corner < 3; ++corner) gradient[corner] = vec4(sum[corner], 0.0);
}
