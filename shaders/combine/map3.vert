#version 450 core
// variants: BATCH=1,2,4 TERMS=1,2,9 PROJECTED=-,1
// variants: BATCH=2 TERMS=2,9 PROJECTED=-,1 WEIGHTED=1
// Tiles of surface maps with what their three vertices hold for the whole tile in every image of a batch: pixel
// coordinates and the values of view maps.
#include "distribute/tiles.glsl"
#include "distribute/cover_tile.glsl"
#include "gather/maps.glsl"
#include "combine/values3.glsl"
uniform vec2 layout_size;  // texels
layout(location = 3) in uint tile;
layout(location = 4) in uvec3 vertices;
uniform sampler2DArray view_values;
layout(location = 0) flat out ivec3 frame;
layout(location = 1) flat out VIEW_VALUE value[VALUES];
#ifdef PROJECTED
#include "combine/cameras.glsl"
layout(location = 0) in vec3 position0;
layout(location = 1) in vec3 position1;
layout(location = 2) in vec3 position2;
layout(location = 1 + VALUES) flat out vec3 projected[3 * BATCH];  // [image][corner], homogeneous pixel coordinates
#endif
const int columns = COLUMNS;

#define HAND_ON(image) hand_on(image, problem)
void hand_on(int image, ivec2 problem[3]) {
#ifndef VALUES_FETCHED
    for (int corner = 0; corner < 3; ++corner)
        for (int k = 0; k < TERMS; ++k)
            value[(image * 3 + corner) * TERMS + k] =
                VIEW_VALUE(texelFetch(view_values, ivec3(problem[corner], image * TERMS + k), 0));
#endif
#ifdef PROJECTED
    projected[3 * image] = project(image, position0);
    projected[3 * image + 1] = project(image, position1);
    projected[3 * image + 2] = project(image, position2);
#endif
}

void main() {
    ivec2 problem[3];
    for (int corner = 0; corner < 3; ++corner) {
        int vertex = int(corner == 0 ? vertices.x : corner == 1 ? vertices.y : vertices.z);
        problem[corner] = ivec2(vertex % columns, vertex / columns);
#ifdef VALUES_FETCHED
        value[corner] = VIEW_VALUE(vec4(problem[corner], 0.0, 0.0));
#endif
    }
    FOR_EACH_IMAGE(HAND_ON)
    frame = tile_frame(int(tile), SIDE);
    gl_Position = cover_tile(frame, gl_VertexID % 3, layout_size);
}
