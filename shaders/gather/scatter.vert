#version 450 core
// The ring's sum goes into the four texels of the vertex's footprint: one point of 2 x 2 texels per vertex. Vertices that
// this image adds nothing to are left out.
#include "gather/maps.glsl"
uniform sampler2D ring_sums;
uniform sampler2DArray footprints;  // layers: weights, first texel
uniform vec2 layout_size;  // texels
const int columns = COLUMNS;
invariant gl_Position;
layout(location = 0) flat out vec4 weights;
layout(location = 1) flat out ivec4 place;  // of the footprint's first texel, and of the problem
void main() {
    ivec2 problem = ivec2(gl_VertexID % columns, gl_VertexID / columns);
    weights = texelFetch(footprints, ivec3(problem, 0), 0);
    place = ivec4(problem * VIEW_SIDE + ivec2(texelFetch(footprints, ivec3(problem, 1), 0).xy), problem);
    bool nothing = all(equal(texelFetch(ring_sums, problem, 0).rgb, vec3(0.0)));
    gl_PointSize = 2.0;
    // Its centre is where the four meet.
    gl_Position = nothing ? vec4(0.0, 0.0, 2.0, 1.0) : vec4(vec2(place.xy + 1) / layout_size * 2.0 - 1.0, 0.0, 1.0);
}
