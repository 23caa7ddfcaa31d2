#version 450 core
// variants: MODEL=* STORAGE=0,1
// One map of P = diag(J'J) / S-bar, not below 1e-4 of the texel's largest entry.
#include "model/vec3_element.glsl"
#include "model/precondition.glsl"
#include "reflect/parameters.glsl"
uniform MAPS parameters;
uniform sampler2DArray sample_sums;  // direction.frag's DIAGONAL
uniform sampler2D inverse_samples;  // 1 / S-bar
uniform int map;
layout(location = 0) out STORED precondition;

vec3 entries[MAP_COUNT];
float sum_of(int column) { return texelFetch(sample_sums, ivec3(ivec2(gl_FragCoord.xy), column / 4), 0)[column % 4]; }

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    vec3 last = load(texelFetch(parameters, ivec3(place, BASIS_COUNT - 1), 0));
    float largest = 0.0;
    for (int k = 0; k < BASIS_COUNT; ++k) entries[k] = vec3(sum_of(k));
    for (int j = 0; j < SHAPE_MAPS; ++j)
        for (int c = 0; c < 3; ++c)
            entries[BASIS_COUNT + j][c] = 3 * j + c < SHAPE_COUNT ? shape_factor(last) * sum_of(BASIS_COUNT + 3 * j + c) : 0.0;
    for (int i = 0; i < MAP_COUNT; ++i)
        largest = max(largest, max(entries[i].r, max(entries[i].g, entries[i].b)));
    float inverse = texelFetch(inverse_samples, place, 0).r;
    precondition = store_positive(preconditioner(entries[map] * inverse, vec3(largest * inverse), vec3(1.0e-30)));
}
