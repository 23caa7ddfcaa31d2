#version 450 core
// One pass into SLS for one image: the colour that each texel takes, alpha 1 where there is one, and the surface
// gradient of the first term for all three corners, blended.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#include "combine/value_of.glsl"
#include "combine/take_item.glsl"
layout(binding = 2) uniform MAPS surface;
#include "combine/residual3.glsl"
layout(location = 3) uniform vec2 image_size;  // pixels
layout(location = 0) flat in vec3 corner0;
layout(location = 1) flat in vec3 corner1;
layout(location = 2) flat in vec3 corner2;
layout(location = 3) flat in ivec3 frame;
layout(location = 0) out uvec4 taken;
layout(location = 1) out vec4 gradient[3];

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    vec3 weights = cell_barycentric((place - frame.xy) * frame.z);
    uvec3 channels;
    bool present = take_item(corner0, corner1, corner2, weights, place, image_size, channels);
    taken = present ? uvec4(channels, 1u) : uvec4(0u);
    vec3 target = target_of(channels);
    for (int corner = 0; corner < 3; ++corner) {
        vec3 r = residual_of(corner, target, weights, place);
        gradient[corner] = present ? vec4(lfm_gradient_surface(r, value_of(corner, 0)), 0.0) : vec4(0.0);
    }
}
