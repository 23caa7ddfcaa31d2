// As distribute/camera.glsl for every image of a batch.
#include "combine/batch.glsl"
uniform vec4 cameras[3 * BATCH];
// Width and height in pixels, 0 where the batch has no such image; the target of a unit of a 16-bit channel.
uniform vec4 image_extents[BATCH];

// Precise, and in the same order: a texel must see the same bits as in every other pass.
vec3 project(int image, vec3 world) {
    precise vec3 q = vec3(dot(cameras[3 * image], vec4(world, 1.0)), dot(cameras[3 * image + 1], vec4(world, 1.0)),
                          dot(cameras[3 * image + 2], vec4(world, 1.0)));
    return q;
}
