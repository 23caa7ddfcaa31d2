#version 450 core
// One texel's share of lambda E_r + mu E_b, before the gather.
#include "optimize/penalty.glsl"
layout(location = 0) out vec4 product;
void main() {
    vec3 s = texelFetch(laplacian, ivec3(site_place(), site_corner), 0).rgb;
    product = vec4(0.5 * smoothness() * s * s + bound_error(x_here()), 0.0);
}
