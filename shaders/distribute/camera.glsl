// The pinhole camera of the image at hand: rows (u, v, w) of its 3 x 4 matrix, so that pixel = (u, v) / w and w is the
// camera depth. Image row 0 is framebuffer row 0.
#include "distribute/camera_row.glsl"
uniform vec4 camera[3];
uniform vec2 image_size;  // pixels

// Homogeneous pixel coordinates.
vec3 project(vec3 world) {
    return vec3(camera_row(camera[0], world), camera_row(camera[1], world), camera_row(camera[2], world));
}

// As the CPU rasterizer: a triangle that reaches behind the camera is dropped whole.
bool in_front(vec3 q0, vec3 q1, vec3 q2) { return min(q0.z, min(q1.z, q2.z)) > 1.0e-6; }
