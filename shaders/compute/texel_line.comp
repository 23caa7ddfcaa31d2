#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 MODEL=* WIDE=-,1
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 MODEL=* LOSS=* WEIGHTED=1
// At p along d: sums over a texel's samples of a^2 and of a^2 + r b, penalties included, with a and b the first and second
// derivative of the model's value.
#include "optimize/dialect.glsl"
#include "compute/texels.glsl"
#undef element
#define element float
#include "model/loss.glsl"
uniform samplerBuffer point;
uniform samplerBuffer direction;
void main() {
    if (!is_active()) return;
    Samples all = samples_of_texel();
    Parameters p = fetch_parameters(point), d = fetch_parameters(direction);
    vec2 sum = vec2(0.0);
    for (uint i = 0u; i < all.count; ++i) {
        Sample s = sample_at(all, i);
        Basis value = basis(p.shape, s.terms);
        vec3 r = value_of(p, value) - s.target, a, b;
        bend_of(p, d, value, s.terms, a, b);
        float squares = dot(a, a), squared = SAMPLE_WEIGHTED(s, dot(r, r));
        sum += SAMPLE_WEIGHTED(s, LOSS_WEIGHTED(squared, vec2(squares, squares + dot(r, b))));
    }
    vec3 penalty = vec3(0.0);
    for (int map = 0; map < MAP_COUNT; ++map)
        penalty += bound_curvature(map, texelFetch(point, int(element_index(map))).rgb,
                                   texelFetch(direction, int(element_index(map))).rgb);
    float inverse = all.count > 0u ? 1.0 / float(all.count) : 0.0;
    problems[texel_index()].yz = sum * inverse + (penalty.r + penalty.g + penalty.b);
}
