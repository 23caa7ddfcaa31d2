#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 MODEL=lafortune UPDATE=*
// One update of an optimizer, for every element of some vectors.
#include "optimize/dialect.glsl"
#include "optimize/TEXT.glsl"
#include "compute/texels.glsl"
layout(std430) buffer Vectors { vec4 x[]; } vectors[VECTORS];
layout(std430) readonly buffer Products { float products[]; };  // [product][texel]
uniform int number_indices[MOST_REGISTERS];
uniform vec4 constants;
void main() {
    if (!is_alive()) return;
    Registers of_problem;
    for (int k = 0; k < NUMBERS; ++k) of_problem.x[k] = vec3(number_of(number_indices[k]));
    for (int k = 0; k < PRODUCTS; ++k)
        of_problem.x[NUMBERS + k] = vec3(products[uint(number_indices[NUMBERS + k]) * uint(texel_count) + texel_index()]);
    Constants of_all;
    for (int k = 0; k < MOST_CONSTANTS; ++k) of_all.x[k] = constants[k];
    for (int map = 0; map < MAP_COUNT; ++map) {
        uint at = element_index(map);
        Elements e;
        for (int k = 0; k < VECTORS; ++k) e.x[k] = vectors[k].x[at].xyz;
        UPDATE(e, of_problem, of_all);
        for (int k = 0; k < WRITTEN; ++k) vectors[k].x[at] = vec4(e.x[k], 0.0);
    }
}
