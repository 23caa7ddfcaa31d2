#version 450 core
// As gather/map.vert for all three corners at once: value[corner * TERMS + k], or with ONE_TERM value[corner] of `term`.
#include "distribute/tile.glsl"
#include "gather/maps.glsl"
#include "combine/values3.glsl"

layout(location = 9) uniform int columns;
layout(location = 10) uniform int term;
layout(binding = 5) uniform sampler2DArray view_values;
layout(location = 4) in uvec3 vertices;
layout(location = 5) flat out vec3 value[VALUES];

void main() {
    place_tile();
    for (int corner = 0; corner < 3; ++corner) {
        int vertex = int(corner == 0 ? vertices.x : corner == 1 ? vertices.y : vertices.z);
        ivec2 problem = ivec2(vertex % columns, vertex / columns);
#ifdef VALUES_FETCHED
        value[corner] = vec3(problem, 0.0);
#else
        for (int k = 0; k < VALUES / 3; ++k)
            value[corner * (VALUES / 3) + k] = texelFetch(view_values, ivec3(problem, term + k), 0).rgb;
#endif
    }
}
