#version 450 core
// The gradient of E_t: sums over samples / S-bar + lambda L'L x + mu dE_b.
#include "optimize/penalty.glsl"
uniform int fitted;  // 0: this term stays as it is
layout(location = 0) out STORED gradient;
vec3 at(ivec2 place) { return texelFetch(laplacian, ivec3(place, site_corner), 0).rgb; }
void main() {
    vec3 twice;
    LAPLACIAN(twice, at)
    vec3 data = texelFetch(sample_sums, site_texel(term), 0).rgb;
    vec3 slope = data * inverse_density() + smoothness() * twice + bound_slope(x_here());
    gradient = store(fitted != 0 ? slope : vec3(0.0));
}
