#version 300 es
// The tiles of a mesh's triangles in the atlas: each a triangle that holds the centres of its cells. Unless all are wanted, those
// are left out that no pixel shows, since they and those across their edges, from which pixels may be interpolated, face away;
// and so are those of other groups than the one whose turn it is.
precision highp float;
precision highp int;
precision highp sampler2D;
#include "view/table.glsl"
#include "view/triangles.glsl"
#include "view/atlas.glsl"
#include "view/frame.glsl"
uniform vec2 atlas_size;
uniform int groups, group;  // groups 0: all
in vec3 position;
flat out int triangle;
flat out ivec4 corners;
flat out vec3 position0, position1, position2;
flat out vec3 normal0, normal1, normal2;

// Or is seen nearly from the side: a rasterizer may decide otherwise there.
bool faces_eye(ivec3 vertices) {
    vec3 a = vertex_position(vertices.x);
    vec3 outwards = cross(vertex_position(vertices.y) - a, vertex_position(vertices.z) - a);
    return dot(outwards, direction_to(eye, a)) > -0.02 * length(outwards);
}

void main() {
    triangle = gl_VertexID / 3;
    int corner = gl_VertexID % 3;
    corners = corners_of(triangle);
    position0 = vertex_position(corners.x);
    position1 = vertex_position(corners.y);
    position2 = vertex_position(corners.z);
    normal0 = vertex_normal(corners.x);
    normal1 = vertex_normal(corners.y);
    normal2 = vertex_normal(corners.z);
    bool shown = groups == 0 || faces_eye(corners.xyz);
    ivec3 across = across_of(triangle);
    for (int c = 0; c < 3; ++c)
        if (!shown && across[c] >= 0) shown = faces_eye(corners_of(across[c]).xyz);
    if (groups > 1 && triangle % groups != group) shown = false;
    // Half a cell beyond the tile's diagonal, so that centres on it lie inside.
    float side = float(corners.w) + 0.5;
    vec2 at = vec2(corner == 1 ? side : 0.0, corner == 2 ? side : 0.0);
    if (triangle % 2 != 0) at = vec2(float(largest_side), float(largest_side + 1)) - at;
    at += vec2(rectangle_of(triangle));
    gl_Position = vec4(shown ? 2.0 * at / atlas_size - 1.0 : vec2(-2.0), 0.0, 1.0);
}
