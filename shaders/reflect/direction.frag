#version 450 core
// variants: MODEL=* GRID=-,1 KEPT=-,1 ONE_CAMERA=-,1 COLOUR=8,16 DIAGONAL=-,1
// variants: MODEL=* LOSS=* WEIGHTED=1 KEPT=-,1 DIAGONAL=-,1
// Sums over samples of each texel, blended: the gradient, laid out as the parameters are, with the sum of r^2 in the
// first map's alpha; and with DIAGONAL the squares of the Jacobian's columns, four a target, those of the shape without
// shape_factor().
#include "reflect/parameters.glsl"
#include "reflect/observe.glsl"
#define element float
#include "model/loss.glsl"
uniform MAPS parameters;
#ifdef DIAGONAL
#define RESULTS (MAP_COUNT + (BASIS_COUNT + SHAPE_COUNT + 3) / 4)
#else
#define RESULTS MAP_COUNT
#endif
#include "common/output.glsl"

#define ADD(s) add(s, p, results)
void add(Sample s, Parameters p, inout vec4 results[RESULTS]) {
    Basis b = basis(p.shape, s.terms);
    vec3 r = residual_of(p, b, s);
    float squared = SAMPLE_WEIGHTED(s, dot(r, r));
    results[0].a += LOSS_VALUE(squared);
    r = SAMPLE_WEIGHTED(s, LOSS_WEIGHTED(squared, r));
    float columns[BASIS_COUNT + SHAPE_COUNT];
    for (int k = 0; k < BASIS_COUNT; ++k) {
        columns[k] = s.counts ? b.x[k] : 0.0;
        results[k].rgb += r * columns[k];
    }
#if SHAPE_COUNT > 0
    Slope slope = shape_slope(p.shape, s.terms);
#if SHAPED_COUNT > 1
    for (int i = 0; i < SHAPE_COUNT * SHAPED_COUNT; ++i) slope.x[i] = s.counts ? slope.x[i] : 0.0;
    for (int l = 0; l < SHAPED_COUNT; ++l) {
        float along = dot(r, p.a[PLAIN_COUNT + l]);
        for (int i = 0; i < SHAPE_COUNT; ++i)
            results[BASIS_COUNT + i / 3][i % 3] += along * slope.x[l * SHAPE_COUNT + i];
    }
    for (int i = 0; i < SHAPE_COUNT; ++i) columns[BASIS_COUNT + i] = sqrt(shape_square(p, slope, i));
#else
    float along = dot(r, p.a[PLAIN_COUNT]);
    for (int i = 0; i < SHAPE_COUNT; ++i) {
        columns[BASIS_COUNT + i] = s.counts ? slope.x[i] : 0.0;
        results[BASIS_COUNT + i / 3][i % 3] += along * columns[BASIS_COUNT + i];
    }
#endif
#endif
#ifdef DIAGONAL
    for (int i = 0; i < BASIS_COUNT + SHAPE_COUNT; ++i)
        results[MAP_COUNT + i / 4][i % 4] += SAMPLE_WEIGHTED(s, LOSS_WEIGHTED(squared, columns[i] * columns[i]));
#endif
}

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    Site site = site_at(place);
    Parameters p = read_parameters(parameters, place);
    vec4 results[RESULTS];
    for (int i = 0; i < RESULTS; ++i) results[i] = vec4(0.0);
    EACH_SAMPLE(ADD)
    WRITE(results);
}
