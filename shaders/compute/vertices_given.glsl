// Problems of light field maps: three of a vertex, its colour channels.
#include "compute/problems.glsl"
layout(std430) readonly buffer Problems { vec4 problems[]; };  // [vertex][OF_VERTEX]
layout(std430) readonly buffer Products { vec4 products[]; };  // [vertex][product_count]

Given given_of(uint problem) {
    uint vertex = problem / 3u, channel = problem % 3u;
    uint of_vertex = vertex * uint(OF_VERTEX), line = of_vertex + uint(OF_LINE);
    Given given;
    given.texels = problems[of_vertex + uint(OF_DENSITY)].y;
    given.trial_error = problems[of_vertex + uint(OF_ERROR)][channel];
    given.line = LineSums(problems[line][channel], problems[line + 1u][channel], problems[line + 2u][channel],
                          problems[line + 3u][channel]);
    for (int i = 0; i < STEP_PRODUCTS; ++i)
        given.products[i] = i < product_count ? products[vertex * uint(product_count) + uint(i)][channel] : 0.0;
    return given;
}
