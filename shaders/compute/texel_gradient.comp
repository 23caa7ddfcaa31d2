#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 MODEL=* DIAGONAL=-,1 WIDE=-,1
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 MODEL=* LOSS=* WEIGHTED=1 DIAGONAL=-,1
// At the trial: E_t of a texel and its gradient, penalties included; DIAGONAL: also the fresh preconditioner.
#include "optimize/dialect.glsl"
#include "model/precondition.glsl"
#include "compute/texels.glsl"
#undef element
#define element float
#include "model/loss.glsl"
uniform samplerBuffer trial;
layout(std430) writeonly buffer Gradient { vec4 gradient[]; };
#ifdef DIAGONAL
layout(std430) writeonly buffer Fresh { vec4 fresh[]; };
#endif
#define JACOBIAN_COLUMNS (BASIS_COUNT + SHAPE_COUNT)
void main() {
    if (!is_active()) return;
    Samples all = samples_of_texel();
    Parameters p = fetch_parameters(trial);
    vec3 slope[MAP_COUNT];
    float error = 0.0, squares[JACOBIAN_COLUMNS];
    for (int map = 0; map < MAP_COUNT; ++map) slope[map] = vec3(0.0);
    for (int i = 0; i < JACOBIAN_COLUMNS; ++i) squares[i] = 0.0;
    for (uint i = 0u; i < all.count; ++i) {
        Sample s = sample_at(all, i);
        Basis b = basis(p.shape, s.terms);
        vec3 r = value_of(p, b) - s.target;
        float squared = SAMPLE_WEIGHTED(s, dot(r, r));
        error += LOSS_VALUE(squared);
        r = SAMPLE_WEIGHTED(s, LOSS_WEIGHTED(squared, r));
        float square[JACOBIAN_COLUMNS];
        for (int k = 0; k < BASIS_COUNT; ++k) {
            square[k] = b.x[k] * b.x[k];
            slope[k] += r * b.x[k];
        }
#if SHAPE_COUNT > 0
        Slope of_shape = shape_slope(p.shape, s.terms);
        for (int l = 0; l < SHAPED_COUNT; ++l) {
            float along = dot(r, p.a[PLAIN_COUNT + l]);
            for (int j = 0; j < SHAPE_COUNT; ++j)
                slope[BASIS_COUNT + j / 3][j % 3] += along * of_shape.x[l * SHAPE_COUNT + j];
        }
        for (int j = 0; j < SHAPE_COUNT; ++j) square[BASIS_COUNT + j] = shape_square(p, of_shape, j);
#endif
#ifdef DIAGONAL
        for (int j = 0; j < JACOBIAN_COLUMNS; ++j) squares[j] += SAMPLE_WEIGHTED(s, LOSS_WEIGHTED(squared, square[j]));
#endif
    }
    float inverse = all.count > 0u ? 1.0 / float(all.count) : 0.0;
    vec3 penalty = vec3(0.0);
    for (int map = 0; map < MAP_COUNT; ++map) {
        vec3 x = texelFetch(trial, int(element_index(map))).rgb;
        penalty += bound_error(map, x);
        gradient[element_index(map)] = vec4(where_free(map, slope[map] * inverse + bound_slope(map, x)), 0.0);
    }
    problems[texel_index()].x = 0.5 * inverse * error + penalty.r + penalty.g + penalty.b;
#ifdef DIAGONAL
    vec3 entries[MAP_COUNT], last = p.a[BASIS_COUNT - 1];
    float largest = 0.0;
    for (int k = 0; k < BASIS_COUNT; ++k) entries[k] = vec3(squares[k]);
    for (int j = 0; j < SHAPE_MAPS; ++j)
        for (int c = 0; c < 3; ++c)
            entries[BASIS_COUNT + j][c] = 3 * j + c < SHAPE_COUNT ? shape_factor(last) * squares[min(BASIS_COUNT + 3 * j + c, JACOBIAN_COLUMNS - 1)] : 0.0;
    for (int map = 0; map < MAP_COUNT; ++map) largest = max(largest, max(entries[map].r, max(entries[map].g, entries[map].b)));
    for (int map = 0; map < MAP_COUNT; ++map)
        fresh[element_index(map)] =
            vec4(preconditioner(entries[map] * inverse, vec3(largest * inverse), vec3(1.0e-30)), 0.0);
#endif
}
