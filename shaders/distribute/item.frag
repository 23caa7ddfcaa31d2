#version 450 core
// The texture item buffer: which SLS texel a pixel's centre sees. COLOUR 8 or 16: with the pixel's colour in so many bits
// a channel, so that a texel finds both in one look-up; pixels outside the mask are seen by none. PART: a frame of zeros has
// no texels.
#include "distribute/tiles.glsl"

layout(location = 0) in vec2 barycentric;
layout(location = 1) flat in ivec3 frame;
#ifdef COLOUR
uniform usampler2D image;
layout(location = 0) out uvec4 item;  // row * layout_width + column, colour
#else
layout(location = 0) out uint item;  // row * layout_width + column
#endif

void main() {
    ivec2 cell = clamp(ivec2(barycentric * float(SIDE)), ivec2(0), ivec2(SIDE - 1));
    // Beyond the diagonal by rounding only: one step back along the longer coordinate.
    if (cell.x + cell.y >= SIDE) cell -= cell.x > cell.y ? ivec2(1, 0) : ivec2(0, 1);
    ivec2 place = frame.xy + frame.z * cell;
    uint index = uint(place.y * layout_width + place.x);
#ifdef PART
    if (frame.z == 0) index = 0xffffffffu;
#endif
#ifdef COLOUR
    uvec4 channels = texelFetch(image, ivec2(gl_FragCoord.xy), 0);
    if (channels.a == 0u) index = 0xffffffffu;
#if COLOUR == 8
    item = uvec4(index, channels.r | channels.g << 8 | channels.b << 16, 0u, 0u);
#else
    item = uvec4(index, channels.r | channels.g << 16, channels.b, 0u);
#endif
#else
    item = index;
#endif
}
