#version 450 core
// variants: MODEL=* GRID=-,1 KEPT=-,1 ONE_CAMERA=-,1 COLOUR=8,16
// variants: MODEL=* LOSS=* WEIGHTED=1 KEPT=-,1
// Sums over samples of each texel along d, blended: of a^2 and of a^2 + r b, with a and b the first and second derivative
// of the model's value (C++: TexelLocal::bend).
#include "reflect/parameters.glsl"
#include "reflect/observe.glsl"
#define element float
#include "model/loss.glsl"
uniform MAPS parameters;
uniform MAPS direction;
#define RESULTS 1
#include "common/output.glsl"

#define ADD(s) add(s, p, d, results)
void add(Sample s, Parameters p, Parameters d, inout vec4 results[RESULTS]) {
    Basis value = basis(p.shape, s.terms);
    vec3 r = residual_of(p, value, s), a, b;
    bend_of(p, d, value, s.terms, a, b);
    a = s.counts ? a : vec3(0.0);
    b = s.counts ? b : vec3(0.0);
    float squares = dot(a, a), squared = SAMPLE_WEIGHTED(s, dot(r, r));
    results[0].rg += SAMPLE_WEIGHTED(s, LOSS_WEIGHTED(squared, vec2(squares, squares + dot(r, b))));
}

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    Site site = site_at(place);
    Parameters p = read_parameters(parameters, place), d = read_parameters(direction, place);
    vec4 results[RESULTS];
    results[0] = vec4(0.0);
    EACH_SAMPLE(ADD)
    WRITE(results);
}
