// A texel's parameters in RGBA maps, layers of one array: map k < BASIS_COUNT holds the coefficients of basis function k,
// one per channel; behind them comes the shape, three numbers a map. Lafortune's nine parameters are the paper's three
// maps: rho_d, rho_s, (Cx, Cz, log n).
#include "model/prelude.glsl"
#include "model/MODEL.glsl"
#include "gather/maps.glsl"
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
