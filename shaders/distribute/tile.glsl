// Vertex side of pass 2 of Section 5.1.1: the mesh's triangles rasterized into their SLS tiles. Back faces, triangles
// behind the camera and triangles beside the image are left out here, before any fragment runs.
#include "distribute/camera.glsl"
#include "distribute/tiles.glsl"

layout(location = 4) uniform int rectangles;
layout(location = 6) uniform vec2 layout_size;  // texels
layout(location = 7) uniform int every_tile;    // 1: no camera, draw all

layout(location = 0) in vec3 position0;
layout(location = 1) in vec3 position1;
layout(location = 2) in vec3 position2;
layout(location = 3) in uint tile;

layout(location = 0) flat out vec3 corner0;  // homogeneous pixel coordinates of the triangle's vertices
layout(location = 1) flat out vec3 corner1;
layout(location = 2) flat out vec3 corner2;
layout(location = 3) flat out ivec3 frame;
layout(location = 4) flat out int tile_index;

bool beside_image(vec3 q0, vec3 q1, vec3 q2) {
    vec3 u = vec3(q0.x, q1.x, q2.x), v = vec3(q0.y, q1.y, q2.y), w = vec3(q0.z, q1.z, q2.z);
    return all(lessThan(u, vec3(0.0))) || all(lessThan(v, vec3(0.0))) || all(greaterThan(u, w * image_size.x)) ||
           all(greaterThan(v, w * image_size.y));
}

void place_tile() {
    corner0 = project(position0);
    corner1 = project(position1);
    corner2 = project(position2);
    frame = tile_frame(int(tile), rectangles);
    tile_index = int(tile);
    // Counter-clockwise triangles face outward; image y points down, so a front face turns the other way here.
    bool visible = every_tile != 0 || (in_front(corner0, corner1, corner2) && dot(corner0, cross(corner1, corner2)) < 0.0 &&
                   !beside_image(corner0, corner1, corner2));
    // The hypotenuse runs half a texel beyond the diagonal cells' centres, so exactly the tile's texels are covered.
    vec2 corner = vec2(gl_VertexID % 3 == 1, gl_VertexID % 3 == 2) * (float(SIDE) + 0.5);
    vec2 start = vec2(frame.xy) + (frame.z > 0 ? 0.0 : 1.0);
    vec2 at = (start + float(frame.z) * corner) / layout_size * 2.0 - 1.0;
    gl_Position = vec4(visible ? at : vec2(-2.0), 0.0, 1.0);
}
