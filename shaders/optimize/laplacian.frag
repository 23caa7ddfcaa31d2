#version 450 core
// L x of one term of one corner's surface maps, or of the view maps (Eq. 9).
#include "optimize/site.glsl"
uniform MAPS maps;
uniform int term;
layout(location = 0) out vec4 result;
vec3 at(ivec2 place) { return load(texelFetch(maps, ivec3(place, site_corner * TERMS + term), 0)); }
void main() {
    vec3 sum;
    LAPLACIAN(sum, at)
    result = vec4(sum, 0.0);
}
