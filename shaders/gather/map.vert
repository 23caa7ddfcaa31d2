#version 450 core
// Tiles of one corner's surface maps, with what the corner's vertex holds for the whole tile: its place among the
// problems and the values of its view maps in this image (constant over the ring, Section 5.2.1).
// VALUES of them, from `term` on, travel as flat varyings; 0 leaves the fragment to fetch them, and no texture is read here.
#include "distribute/tile.glsl"
#include "gather/maps.glsl"
#ifndef VALUES
#define VALUES 0
#endif

uniform int corner;
const int columns = COLUMNS;
uniform int term;

layout(location = 4) in uvec3 vertices;
layout(location = 5) flat out ivec2 problem;
#if VALUES > 0
uniform sampler2DArray view_values;
layout(location = 6) flat out vec3 value[VALUES];
#ifdef ALONG
uniform sampler2DArray view_slopes;
layout(location = 14) flat out vec3 slope[VALUES];
#endif
#endif

void main() {
    place_tile();
    int vertex = int(corner == 0 ? vertices.x : corner == 1 ? vertices.y : vertices.z);
    problem = ivec2(vertex % columns, vertex / columns);
#if VALUES > 0
    for (int k = 0; k < VALUES; ++k) {
        value[k] = texelFetch(view_values, ivec3(problem, term + k), 0).rgb;
#ifdef ALONG
        slope[k] = texelFetch(view_slopes, ivec3(problem, term + k), 0).rgb;
#endif
    }
#endif
}
