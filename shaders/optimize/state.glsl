// ProblemState in textures: one layer per field, r, g, b the vertex's three problems.
#include "model/prelude.glsl"
#include "optimize/problem_state.glsl"
#include "optimize/after_direction.glsl"
#include "optimize/after_line.glsl"
layout(binding = 7) uniform sampler2DArray state;
layout(binding = 8) uniform sampler2DArray sample_sums;  // layers: Sum in gl/problem_textures.h
layout(binding = 9) uniform sampler2DArray map_sums;
layout(binding = 12) uniform sampler2DArray constants;  // layer 0: 1/S-bar, ring texels
layout(binding = 14) uniform sampler2D steps;          // alpha

ProblemState read_state(ivec2 at, int c) {
    ProblemState s;
    s.error = texelFetch(state, ivec3(at, 0), 0)[c];
    s.norm = texelFetch(state, ivec3(at, 1), 0)[c];
    s.slope = texelFetch(state, ivec3(at, 2), 0)[c];
    s.step_factor = texelFetch(state, ivec3(at, 3), 0)[c];
    s.beta = texelFetch(state, ivec3(at, 4), 0)[c];
    s.accepted = texelFetch(state, ivec3(at, 5), 0)[c];
    s.status = texelFetch(state, ivec3(at, 6), 0)[c];
    s.iterations = texelFetch(state, ivec3(at, 7), 0)[c];
    return s;
}
float sum_over_samples(int sum, ivec2 at, int c) { return texelFetch(sample_sums, ivec3(at, sum), 0)[c]; }
float sum_over_maps(int sum, ivec2 at, int c) { return texelFetch(map_sums, ivec3(at, sum - 5), 0)[c]; }
