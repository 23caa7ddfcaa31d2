#version 450 core
// variants: MODEL=* GRID=-,1 KEPT=-,1 ONE_CAMERA=-,1 COLOUR=8,16 CANDIDATES=1,5
// variants: MODEL=* WEIGHTED=1 KEPT=-,1 CANDIDATES=1
// Sums over samples of each texel, blended: what linear least squares in the coefficients needs for CANDIDATES shapes,
// numbers FIRST and those behind it, four a target. In their order (C++: fragment/texel_start.h): products of the basis functions
// that no shape enters, in pairs and with the target; for each candidate those of the others with all before and the target.
#include "reflect/parameters.glsl"
#include "reflect/observe.glsl"
#ifndef FIRST
#define FIRST 0
#define RESULTS 1
#endif
#include "common/output.glsl"
#define NUMBERS_OF(functions) ((functions) * ((functions) + 1) / 2 + 3 * (functions))
#define EACH_CANDIDATE (NUMBERS_OF(BASIS_COUNT) - NUMBERS_OF(PLAIN_COUNT))
#define NUMBERS (NUMBERS_OF(PLAIN_COUNT) + CANDIDATES * EACH_CANDIDATE)
#if SHAPE_COUNT > 0
uniform vec4 shapes[CANDIDATES * SHAPE_MAPS];  // three numbers each
#endif

// Adds the products of basis function k with those up to k and with the target, from number `at` on.
#define ADD_PRODUCTS(k, at)                                          \
    {                                                                \
        for (int j = 0; j < BASIS_COUNT; ++j)                        \
            if (j <= k) sums[(at) + j] += SAMPLE_WEIGHTED(s, b.x[k]) * b.x[j]; \
        for (int c = 0; c < 3; ++c) sums[(at) + k + 1 + c] += SAMPLE_WEIGHTED(s, b.x[k]) * t[c]; \
    }

#define ADD(s) add(s, sums)
void add(Sample s, inout float sums[NUMBERS]) {
    vec3 t = s.counts ? s.target : vec3(0.0);
    for (int candidate = 0; candidate < CANDIDATES; ++candidate) {
        Shape shape;
        shape.x[0] = 0.0;
#if SHAPE_COUNT > 0
        for (int i = 0; i < SHAPE_COUNT; ++i) shape.x[i] = shapes[candidate * SHAPE_MAPS + i / 3][i % 3];
#endif
        Basis b = basis(shape, s.terms);
        for (int k = 0; k < BASIS_COUNT; ++k) b.x[k] = s.counts ? b.x[k] : 0.0;
        if (candidate == 0)
            for (int k = 0; k < PLAIN_COUNT; ++k) ADD_PRODUCTS(k, NUMBERS_OF(k))
        for (int k = PLAIN_COUNT; k < BASIS_COUNT; ++k) ADD_PRODUCTS(k, NUMBERS_OF(k) + candidate * EACH_CANDIDATE)
    }
}

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    Site site = site_at(place);
    float sums[NUMBERS];
    for (int i = 0; i < NUMBERS; ++i) sums[i] = 0.0;
    EACH_SAMPLE(ADD)
    vec4 results[RESULTS];
    for (int i = 0; i < RESULTS; ++i)
        for (int c = 0; c < 4; ++c)
            results[i][c] = FIRST + 4 * i + c < NUMBERS ? sums[min(FIRST + 4 * i + c, NUMBERS - 1)] : 0.0;
    WRITE(results);
}
