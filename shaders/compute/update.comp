#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=2 VIEW_SIDE=8 UPDATE=*
// One update of an optimizer, for every element of some vectors.
#include "compute/vertices.glsl"
#include "optimize/elements.glsl"
#include "optimize/TEXT.glsl"
layout(std430) buffer Vectors { vec4 x[]; } vectors[VECTORS];
layout(std430) readonly buffer Products { vec4 products[]; };
uniform int number_indices[MOST_REGISTERS];
uniform vec4 constants;
uniform int product_count;
void main() {
    if (!is_alive()) return;
    Vertex v = this_vertex();
    Registers of_problem;
    for (int k = 0; k < NUMBERS; ++k) of_problem.x[k] = number_of(number_indices[k]);
    for (int k = 0; k < PRODUCTS; ++k)
        of_problem.x[NUMBERS + k] =
            products[vertex_index() * uint(product_count) + uint(number_indices[NUMBERS + k])].xyz;
    Constants of_all;
    for (int k = 0; k < MOST_CONSTANTS; ++k) of_all.x[k] = constants[k];
    uint end = v.view_first + uint(VIEW_SIDE * VIEW_SIDE * TERMS);
    for (uint i = v.first + lane(); i < end; i += uint(LANES)) {
        Elements e;
        for (int k = 0; k < VECTORS; ++k) e.x[k] = vectors[k].x[i].xyz;
        UPDATE(e, of_problem, of_all);
        for (int k = 0; k < WRITTEN; ++k) vectors[k].x[i] = vec4(e.x[k], 0.0);
    }
}
