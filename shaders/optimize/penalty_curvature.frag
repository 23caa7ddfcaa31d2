#version 450 core
// One texel's share of the penalties' second derivative along d, before the gather; `smoothed` holds L d.
#include "optimize/penalty.glsl"
layout(location = 0) out vec4 product;
void main() {
    vec3 s = texelFetch(smoothed, ivec3(site_place(), site_corner), 0).rgb;
    vec3 d = load(texelFetch(directions, site_texel(term), 0));
    product = vec4(smoothness() * s * s + bound_curvature(x_here()) * d * d, 0.0);
}
