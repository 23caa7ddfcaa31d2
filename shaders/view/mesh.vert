#version 300 es
// A mesh without shared vertices: three to a triangle, so that its number is known.
precision highp float;
precision highp int;
precision highp sampler2D;
#include "view/table.glsl"
#include "view/triangles.glsl"
uniform mat4 clip_from_world;
in vec3 position;
out vec2 barycentric;
flat out int triangle;
flat out ivec4 corners;
flat out ivec3 across;

void main() {
    triangle = gl_VertexID / 3;
    int corner = gl_VertexID % 3;
    barycentric = vec2(corner == 1 ? 1.0 : 0.0, corner == 2 ? 1.0 : 0.0);
    corners = corners_of(triangle);
    across = across_of(triangle);
    gl_Position = clip_from_world * vec4(position, 1.0);
}
