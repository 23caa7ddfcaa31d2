// Vertex side of pass 2 of Section 5.1.1: the mesh's triangles rasterized into their SLS tiles. The host leaves out
// triangles that face away (SlsMesh::select). One that it lets through needlessly takes no pixel, as none
// holds its item. PROJECTED: with the vertices' pixel coordinates, for passes that take pixels.
#include "distribute/tiles.glsl"
#include "distribute/cover_tile.glsl"

uniform vec2 layout_size;  // texels
layout(location = 3) in uint tile;
layout(location = 3) flat out ivec3 frame;
layout(location = 4) flat out int tile_index;

#ifdef PROJECTED
#include "distribute/camera.glsl"
layout(location = 0) in vec3 position0;
layout(location = 1) in vec3 position1;
layout(location = 2) in vec3 position2;
layout(location = 0) flat out vec3 corner0;  // homogeneous pixel coordinates of the triangle's vertices
layout(location = 1) flat out vec3 corner1;
layout(location = 2) flat out vec3 corner2;
#endif

void place_tile() {
#ifdef PROJECTED
    corner0 = project(position0);
    corner1 = project(position1);
    corner2 = project(position2);
#endif
    frame = tile_frame(int(tile), SIDE);
    tile_index = int(tile);
    gl_Position = cover_tile(frame, gl_VertexID % 3, layout_size);
}
