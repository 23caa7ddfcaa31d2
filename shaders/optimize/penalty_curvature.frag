#version 450 core
// One texel's share of the penalties' second derivative along d, before the gather; `laplacian` holds L d.
#include "optimize/penalty.glsl"
layout(location = 0) out vec4 product;
void main() {
    vec3 s = texelFetch(laplacian, ivec3(site_place(), site_corner), 0).rgb;
    vec3 d = load(texelFetch(direction, site_texel(term), 0));
    product = vec4(smoothness() * s * s + bound_curvature(x_here(), d), 0.0);
}
