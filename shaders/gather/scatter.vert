#version 450 core
// The ring's sum goes into the four texels of the vertex's footprint: one quad of 2 x 2 texels per vertex.
#include "gather/maps.glsl"
layout(binding = 10) uniform sampler2DArray footprints;  // layers: weights, first texel
layout(location = 6) uniform vec2 layout_size;  // texels
layout(location = 9) uniform int columns;
layout(location = 0) flat out vec4 weights;
layout(location = 1) flat out ivec4 place;  // of the footprint's first texel, and of the problem
void main() {
    int vertex = gl_VertexID / 6;
    int corner = gl_VertexID % 6;
    ivec2 offset = ivec2(corner == 1 || corner == 2 || corner == 4, corner == 2 || corner == 4 || corner == 5);
    ivec2 problem = ivec2(vertex % columns, vertex / columns);
    weights = texelFetch(footprints, ivec3(problem, 0), 0);
    place = ivec4(problem * VIEW_SIDE + ivec2(texelFetch(footprints, ivec3(problem, 1), 0).xy), problem);
    gl_Position = vec4(vec2(place.xy + 2 * offset) / layout_size * 2.0 - 1.0, 0.0, 1.0);
}
