#version 450 core
// variants: ELEMENTS=map_elements UPDATE=* VIEW_MAPS=-,1 STORAGE=0,1
// variants: ELEMENTS=texel_elements UPDATE=* STORAGE=0,1
// One update of an optimizer, for every element of some vectors: reads and writes its own texel only.
#include "optimize/dialect.glsl"
#include "optimize/numbers.glsl"
#include "optimize/ELEMENTS.glsl"
#include "optimize/TEXT.glsl"
layout(binding = 0) uniform MAPS vectors[VECTORS];
layout(location = 24) uniform int numbers[MOST_REGISTERS];
layout(location = 28) uniform vec4 told;
layout(location = 0) out STORED written[WRITTEN];
void main() {
    Elements e;
    for (int k = 0; k < VECTORS; ++k) e.x[k] = load(texelFetch(vectors[k], element_place(), 0));
    Registers of_problem;
    for (int k = 0; k < NUMBERS; ++k) of_problem.x[k] = number_of(numbers[k]);
    for (int k = 0; k < PRODUCTS; ++k) of_problem.x[NUMBERS + k] = product_of(numbers[NUMBERS + k]);
    Constants constants;
    for (int k = 0; k < MOST_CONSTANTS; ++k) constants.x[k] = told[k];
    UPDATE(e, of_problem, constants);
    for (int k = 0; k < WRITTEN; ++k) written[k] = store(e.x[k]);
}
