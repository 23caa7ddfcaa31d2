#version 450 core
// As gather/map.vert for all three corners at once: value[corner * TERMS + k].
#include "distribute/tile.glsl"
#include "gather/maps.glsl"
#include "combine/values3.glsl"

const int columns = COLUMNS;
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
        for (int k = 0; k < TERMS; ++k)
            value[corner * TERMS + k] = texelFetch(view_values, ivec3(problem, k), 0).rgb;
#endif
    }
}
