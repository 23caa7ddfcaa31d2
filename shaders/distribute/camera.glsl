// The pinhole camera of the image at hand: rows (u, v, w) of its 3 x 4 matrix, so that pixel = (u, v) / w and w is the
// camera depth. Image row 0 is framebuffer row 0.
uniform vec4 camera[3];
uniform vec2 image_size;  // pixels

// Homogeneous pixel coordinates. Precise: every pass must see the same bits, or a sample is taken here and not there.
vec3 project(vec3 world) {
    precise vec3 q = vec3(dot(camera[0], vec4(world, 1.0)), dot(camera[1], vec4(world, 1.0)),
                          dot(camera[2], vec4(world, 1.0)));
    return q;
}

// As the CPU rasterizer: a triangle that reaches behind the camera is dropped whole.
bool in_front(vec3 q0, vec3 q1, vec3 q2) { return min(q0.z, min(q1.z, q2.z)) > 1.0e-6; }
