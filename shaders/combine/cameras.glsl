// As distribute/camera.glsl for every image of a batch.
#include "combine/batch.glsl"
#include "distribute/camera_row.glsl"
uniform vec4 cameras[3 * BATCH];
// Width and height in pixels, 0 where the batch has no such image; the target of a unit of a 16-bit channel.
uniform vec4 image_extents[BATCH];

vec3 project(int image, vec3 world) {
    return vec3(camera_row(cameras[3 * image], world), camera_row(cameras[3 * image + 1], world),
                camera_row(cameras[3 * image + 2], world));
}
