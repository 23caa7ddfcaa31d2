#version 450 core
// variants: ELEMENTS=map_elements UPDATE=* VIEW_MAPS=-,1 STORAGE=0,1 ONLY=-,0
// variants: ELEMENTS=texel_elements UPDATE=* STORAGE=0,1 ONLY=-,0
// One update of an optimizer, for every element of some vectors: reads and writes its own texel only, of all the vectors that it
// changes or of one.
#include "optimize/dialect.glsl"
#include "optimize/numbers.glsl"
#include "optimize/ELEMENTS.glsl"
#include "optimize/TEXT.glsl"
uniform MAPS vectors[VECTORS];
uniform int number_indices[MOST_REGISTERS];
uniform vec4 constants;
#define RESULT STORED
#define RESULTS WRITTEN
#include "common/output.glsl"
void main() {
    Elements e;
    for (int k = 0; k < VECTORS; ++k) e.x[k] = load(texelFetch(vectors[k], element_place(), 0));
    Registers of_problem;
    for (int k = 0; k < NUMBERS; ++k) of_problem.x[k] = number_of(number_indices[k]);
    for (int k = 0; k < PRODUCTS; ++k) of_problem.x[NUMBERS + k] = product_of(number_indices[NUMBERS + k]);
    Constants of_all;
    for (int k = 0; k < MOST_CONSTANTS; ++k) of_all.x[k] = constants[k];
    UPDATE(e, of_problem, of_all);
    STORED stored[WRITTEN];
    for (int k = 0; k < WRITTEN; ++k) stored[k] = store(e.x[k]);
    WRITE(stored);
}
