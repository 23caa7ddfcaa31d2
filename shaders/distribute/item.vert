#version 450 core
// Pass 1 of Section 5.1.1: the mesh in image space. PART: some triangles have no tile (0xffffffff) and only hide others.
#include "distribute/camera.glsl"
#include "distribute/tiles.glsl"

layout(location = 0) in vec3 position0;
layout(location = 1) in vec3 position1;
layout(location = 2) in vec3 position2;
layout(location = 3) in uint tile;

// In all variants of the program, or the list of samples that one makes is not that of another.
invariant gl_Position;
layout(location = 0) out vec2 barycentric;   // weights of the triangle's 2nd and 3rd vertex
layout(location = 1) flat out ivec3 frame;

void main() {
    vec3 q0 = project(position0);
    vec3 q1 = project(position1);
    vec3 q2 = project(position2);
    int corner = gl_VertexID % 3;
    vec3 q = corner == 0 ? q0 : corner == 1 ? q1 : q2;
    barycentric = vec2(corner == 1, corner == 2);
    frame = tile_frame(int(tile), SIDE);
#ifdef PART
    if (tile == 0xffffffffu) frame = ivec3(0);
#endif
    // Depth is 1/w in reverse, 1e-6 / w: a float keeps its relative precision at any distance.
    precise vec4 clip = vec4(2.0 * q.xy / image_size - q.z, 1.0e-6, q.z);
    gl_Position = in_front(q0, q1, q2) ? clip : vec4(0.0, 0.0, 2.0, 1.0);
}
