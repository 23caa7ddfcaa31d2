#version 300 es
// A mesh without shared vertices: three to a triangle, so that its number is known.
precision highp float;
precision highp int;
precision highp sampler2D;
#include "view/table.glsl"
#include "view/triangles.glsl"
uniform mat4 clip_from_world;
in vec3 position;
flat out int triangle;
flat out ivec4 corners;
flat out ivec3 across;
flat out vec3 clip0, clip1, clip2;  // of the corners: x, y and w

vec3 clip_position(int vertex) { return (clip_from_world * vec4(vertex_position(vertex), 1.0)).xyw; }

void main() {
    triangle = gl_VertexID / 3;
    corners = corners_of(triangle);
    across = across_of(triangle);
    clip0 = clip_position(corners.x);
    clip1 = clip_position(corners.y);
    clip2 = clip_position(corners.z);
    gl_Position = clip_from_world * vec4(position, 1.0);
}
