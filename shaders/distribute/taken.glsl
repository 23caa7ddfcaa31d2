// What an SLS texel takes of an image, as distribute/keep.frag left it in a map of the surface: instead of
// distribute/take.glsl where sweeps don't distribute again.
#include "distribute/tiles.glsl"

uniform usampler2D image;
layout(location = 3) flat in ivec3 frame;

// As take() of distribute/take.glsl, but pixel is the texel's place in the map.
bool take(out ivec2 pixel, out uvec4 channels, out vec3 weights) {
    pixel = ivec2(gl_FragCoord.xy);
    weights = cell_barycentric((pixel - frame.xy) * frame.z);
    channels = texelFetch(image, pixel, 0);
    return channels.a != 0u;
}
