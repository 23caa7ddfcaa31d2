#version 300 es
// A mesh without shared vertices: three to a triangle, so that its number is known.
// variants: SURFACE=-,1
precision highp float;
precision highp int;
precision highp sampler2D;
#include "view/table.glsl"
uniform mat4 clip_from_world;
uniform sampler2D vertices;   // [2 vertex]: position; [2 vertex + 1]: normal
uniform sampler2D triangles;  // three vertices, and the tile's side
in vec3 position;
out vec2 barycentric;
flat out int triangle;
flat out ivec4 corners;
#ifdef SURFACE
flat out vec3 position0, position1, position2;
flat out vec3 normal0, normal1, normal2;
#endif

void main() {
    triangle = gl_VertexID / 3;
    int corner = gl_VertexID % 3;
    barycentric = vec2(corner == 1 ? 1.0 : 0.0, corner == 2 ? 1.0 : 0.0);
    corners = ivec4(table_entry(triangles, triangle) + 0.5);
#ifdef SURFACE
    position0 = table_entry(vertices, 2 * corners.x).xyz;
    position1 = table_entry(vertices, 2 * corners.y).xyz;
    position2 = table_entry(vertices, 2 * corners.z).xyz;
    normal0 = table_entry(vertices, 2 * corners.x + 1).xyz;
    normal1 = table_entry(vertices, 2 * corners.y + 1).xyz;
    normal2 = table_entry(vertices, 2 * corners.z + 1).xyz;
#endif
    gl_Position = clip_from_world * vec4(position, 1.0);
}
