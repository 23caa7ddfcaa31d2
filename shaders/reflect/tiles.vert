#version 450 core
// variants: BATCH=1,4
// The mesh's triangles rasterized into their SLS tiles for a batch of images, with the pixel coordinates of their vertices
// in each; those that stand out of all pictures are left out.
#include "distribute/tiles.glsl"
#include "distribute/cover_tile.glsl"
#include "combine/cameras.glsl"
layout(location = 6) uniform vec2 layout_size;  // texels
layout(location = 0) in vec3 position0;
layout(location = 1) in vec3 position1;
layout(location = 2) in vec3 position2;
layout(location = 3) in uint tile;
layout(location = 0) flat out ivec3 frame;
layout(location = 1) flat out vec3 projected[3 * BATCH];  // [image][corner], homogeneous pixel coordinates

#define HAND_ON(image) seen = hand_on(image) || seen
bool hand_on(int image) {
    vec3 q0 = project(image, position0), q1 = project(image, position1), q2 = project(image, position2);
    projected[3 * image] = q0;
    projected[3 * image + 1] = q1;
    projected[3 * image + 2] = q2;
    vec2 lowest = min(q0.xy / q0.z, min(q1.xy / q1.z, q2.xy / q2.z));
    vec2 highest = max(q0.xy / q0.z, max(q1.xy / q1.z, q2.xy / q2.z));
    // With a pixel to spare for rounding. What reaches behind the camera has no item (distribute/camera.glsl).
    return min(q0.z, min(q1.z, q2.z)) > 0.0 && all(greaterThan(highest, vec2(-1.0))) &&
           all(lessThan(lowest, pictures[image].xy + 1.0));
}

void main() {
    bool seen = false;
    FOR_EACH_IMAGE(HAND_ON)
    frame = tile_frame(int(tile), SIDE);
    gl_Position = seen ? cover_tile(frame, gl_VertexID % 3, layout_size) : vec4(0.0, 0.0, 2.0, 1.0);
}
