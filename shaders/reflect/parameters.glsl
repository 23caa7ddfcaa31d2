// A texel's parameters in RGBA maps, layers of one array: map k < BASIS_COUNT holds the coefficients of basis function k,
// one per channel; behind them comes the shape, three numbers a map. Lafortune's nine parameters are the paper's three
// maps: rho_d, rho_s, (Cx, Cz, log n). The last SHAPED_COUNT basis functions depend on the shape.
#include "model/prelude.glsl"
#include "model/MODEL.glsl"
#include "gather/maps.glsl"
#ifndef SHAPED_COUNT
#define SHAPED_COUNT 1
#endif
#define PLAIN_COUNT (BASIS_COUNT - SHAPED_COUNT)
#define SHAPE_MAPS ((SHAPE_COUNT + 2) / 3)
#define MAP_COUNT (BASIS_COUNT + SHAPE_MAPS)

struct Parameters {
    vec3 a[BASIS_COUNT];
    Shape shape;
};

Parameters read_parameters(MAPS maps, ivec2 place) {
    Parameters p;
    for (int k = 0; k < BASIS_COUNT; ++k) p.a[k] = load(texelFetch(maps, ivec3(place, k), 0));
    p.shape.x[0] = 0.0;
    for (int j = 0; j < SHAPE_MAPS; ++j) {
        vec3 three = load(texelFetch(maps, ivec3(place, BASIS_COUNT + j), 0));
        for (int c = 0; c < 3; ++c)
            if (3 * j + c < SHAPE_COUNT) p.shape.x[3 * j + c] = three[c];
    }
    return p;
}

vec3 value_of(Parameters p, Basis b) {
    vec3 m = vec3(0.0);
    for (int k = 0; k < BASIS_COUNT; ++k) m += p.a[k] * b.x[k];
    return m;
}

// First and second derivative of the value along d, which has the basis functions b (C++: TexelLocal::bend).
void bend_of(Parameters p, Parameters d, Basis b, Terms t, out vec3 first, out vec3 second) {
    first = vec3(0.0);
    second = vec3(0.0);
    for (int k = 0; k < BASIS_COUNT; ++k) first += d.a[k] * b.x[k];
#if SHAPE_COUNT > 0
#if SHAPED_COUNT > 1
    Bends along = shape_bends(p.shape, d.shape, t);
    for (int l = 0; l < SHAPED_COUNT; ++l) {
        first += p.a[PLAIN_COUNT + l] * along.x[l].x;
        second += 2.0 * d.a[PLAIN_COUNT + l] * along.x[l].x + p.a[PLAIN_COUNT + l] * along.x[l].y;
    }
#else
    vec2 along = shape_bend(p.shape, d.shape, t);
    first += p.a[PLAIN_COUNT] * along.x;
    second = 2.0 * d.a[PLAIN_COUNT] * along.x + p.a[PLAIN_COUNT] * along.y;
#endif
#endif
}

// The square of the Jacobian's column by number i of the shape, and what the sum of it over samples is to be multiplied
// by: of a single shaped basis function, its coefficients' part.
#if SHAPE_COUNT > 0
#if SHAPED_COUNT > 1
float shape_square(Parameters p, Slope slope, int i) {
    vec3 column = vec3(0.0);
    for (int l = 0; l < SHAPED_COUNT; ++l) column += p.a[PLAIN_COUNT + l] * slope.x[l * SHAPE_COUNT + i];
    return dot(column, column);
}
float shape_factor(vec3 last) { return 1.0; }
#else
float shape_square(Parameters p, Slope slope, int i) { return slope.x[i] * slope.x[i]; }
float shape_factor(vec3 last) { return dot(last, last); }
#endif
#else
float shape_factor(vec3 last) { return 0.0; }
#endif
