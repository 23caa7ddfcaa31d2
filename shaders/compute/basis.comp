#version 450 core
// variants: LANES=8,64 RANK=1,10,28 LIGHT=0
// variants: LANES=8,32 RANK=1,9,27,84 LIGHT=1 TERMS=49 HALF=-,1
// The normal equations of a learned basis over directions, a texel for each work group: the z of least
//     sum over samples of w |y - sum over k of z_k phi_k|^2 + noise |z|^2,    phi_k = u_k . b,  y = colour - m . b.
// By view direction (LIGHT 0) a sample has one row phi, and each channel a z of its own; by lamp direction (LIGHT 1), or with half
// vectors (HALF), it has three rows, a channel's each, and they share z. Samples come LANES at a time: an
// invocation finds phi and y of one, then adds to its own entries of the sums over all of them. The matrix has the right-hand
// sides as its last rows, so that factoring it solves for them, too.
#include "model/prelude.glsl"
#if LIGHT
#include "model/light_kernel.glsl"
#define ROWS 3
#define RIGHT 1
#else
#include "model/view_basis.glsl"
#define TERMS VIEW_TERMS
#define ROWS 1
#define RIGHT 3
#endif
#define COLUMNS (RANK + RIGHT)
#define ENTRIES (COLUMNS * (COLUMNS + 1) / 2)
#define ENTRIES_EACH ((ENTRIES + LANES - 1) / LANES)
layout(local_size_x = LANES) in;
layout(std430) readonly buffer Texels { uvec4 texels[]; };         // where its samples begin; how many; its block
layout(std430) readonly buffer Samples { float samples[]; };       // [sample] direction, colour
layout(std430) readonly buffer Basis { float basis[]; };           // [block][ROWS][TERMS] of m, then of u: COLUMNS
layout(std430) writeonly buffer Solutions { float solutions[]; };  // [texel] z: [RANK][RIGHT]; 1/2 sum r^2
#if LIGHT
layout(std430) readonly buffer Lamps { float lamps[]; };           // [TERMS] directions at which the kernels are
uniform float length_between;                                      // of the kernels
#endif
#ifdef HALF
layout(std430) readonly buffer Halves { float halves[]; };           // [sample] half vectors
layout(std430) readonly buffer LampHalves { float lamp_halves[]; };  // [TERMS]
uniform float half_length, half_share;                               // of the kernels
#endif
uniform int texel_count;
uniform float noise;
shared float columns[LANES][COLUMNS];  // phi, y
shared float weights[LANES];
shared float matrix[ENTRIES];  // lower triangle, row by row
shared float colours[3 * TERMS];  // of the texel, as polynomials or sums of kernels

int lane() { return int(gl_LocalInvocationIndex); }
int at(int row, int column) { return row * (row + 1) / 2 + column; }
vec3 three(uint first) { return vec3(samples[first], samples[first + 1u], samples[first + 2u]); }

// b
void find_terms(uint s, out float b[TERMS]) {
    vec3 direction = three(6u * s);
#ifdef HALF
    vec3 between = vec3(halves[3u * s], halves[3u * s + 1u], halves[3u * s + 2u]);
#endif
#if LIGHT
    for (int i = 0; i < TERMS; ++i) {
        vec3 lamp = vec3(lamps[3 * i], lamps[3 * i + 1], lamps[3 * i + 2]);
#ifdef HALF
        vec3 of_lamp = vec3(lamp_halves[3 * i], lamp_halves[3 * i + 1], lamp_halves[3 * i + 2]);
        b[i] = light_pair_kernel(lamp, of_lamp, direction, between, length_between, half_length, half_share);
#else
        b[i] = light_kernel(lamp, direction, length_between);
#endif
    }
#else
    b = view_terms(direction).x;
#endif
}

void find_columns(uint block_first, uint s, float b[TERMS], int row) {
    vec3 colour = three(6u * s + 3u);
    uint first = block_first + uint(row * TERMS * COLUMNS);
    for (int column = 0; column < COLUMNS; ++column) {
        float sum = 0.0;
        for (int i = 0; i < TERMS; ++i) sum += basis[first + uint(i * COLUMNS + column)] * b[i];
        columns[lane()][column < RIGHT ? RANK + column : column - RIGHT] =
            column < RIGHT ? colour[ROWS == 1 ? min(column, 2) : row] - sum : sum;
    }
}

void main() {
    uint texel = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    if (texel >= uint(texel_count)) return;
    uint first = texels[texel].x, count = texels[texel].y, block_first = texels[texel].z * uint(ROWS * TERMS * COLUMNS);
    ivec2 places[ENTRIES_EACH];
    float sums[ENTRIES_EACH];
    for (int i = 0; i < ENTRIES_EACH; ++i) {
        int entry = min(lane() + i * LANES, ENTRIES - 1);
        int row = int(0.5 * sqrt(float(8 * entry + 1)) - 0.49);  // whole + 0.01 at a row's first entry; before it by 0.0017 or more below
        places[i] = ivec2(row, entry - at(row, 0));
        sums[i] = places[i].x == places[i].y ? noise : 0.0;
    }
    for (uint begin = 0u; begin < count; begin += uint(LANES)) {
        int here = int(min(uint(LANES), count - begin));
        uint s = first + begin + uint(min(lane(), here - 1));
        float b[TERMS];
        find_terms(s, b);
        barrier();  // until all have added what the weights were of
#if LIGHT
        weights[lane()] = 1.0;
#else
        weights[lane()] = view_weight(three(6u * s));
#endif
        for (int row = 0; row < ROWS; ++row) {
            barrier();
            if (lane() < here) find_columns(block_first, s, b, row);
            barrier();
            for (int k = 0; k < here; ++k)
                for (int i = 0; i < ENTRIES_EACH; ++i)
                    sums[i] += weights[k] * columns[k][places[i].x] * columns[k][places[i].y];
        }
    }
    for (int i = 0; i < ENTRIES_EACH; ++i) matrix[min(lane() + i * LANES, ENTRIES - 1)] = sums[i];

    for (int k = 0; k < RANK; ++k) {  // Cholesky's decomposition, column by column
        barrier();
        float pivot = sqrt(max(matrix[at(k, k)], noise));  // which it is at least, but for rounding
        barrier();
        for (int row = k + lane(); row < COLUMNS; row += LANES) matrix[at(row, k)] /= pivot;
        barrier();
        for (int i = 0; i < ENTRIES_EACH; ++i)
            if (places[i].y > k && lane() + i * LANES < ENTRIES)
                matrix[lane() + i * LANES] -= matrix[at(places[i].x, k)] * matrix[at(places[i].y, k)];
    }
    barrier();
    for (int c = lane(); c < RIGHT; c += LANES)  // z in place of the right-hand sides
        for (int k = RANK - 1; k >= 0; --k) {
            float sum = matrix[at(RANK + c, k)];
            for (int j = k + 1; j < RANK; ++j) sum -= matrix[at(j, k)] * matrix[at(RANK + c, j)];
            matrix[at(RANK + c, k)] = sum / matrix[at(k, k)];
        }
    barrier();
    uint result = texel * uint(RIGHT * RANK + 1);
    for (int i = lane(); i < RIGHT * RANK; i += LANES) solutions[result + uint(i)] = matrix[at(RANK + i % RIGHT, i / RIGHT)];
    for (int i = lane(); i < 3 * TERMS; i += LANES) {
        int channel = i % 3, right = channel % RIGHT;
        uint row = block_first + uint((channel % ROWS * TERMS + i / 3) * COLUMNS);
        float sum = basis[row + uint(right)];
        for (int k = 0; k < RANK; ++k) sum += matrix[at(RANK + right, k)] * basis[row + uint(RIGHT + k)];
        colours[i] = sum;
    }
    barrier();
    weights[lane()] = 0.0;  // from here on the invocations' parts of the error
    for (uint s = uint(lane()); s < count; s += uint(LANES)) {
        float b[TERMS];
        find_terms(first + s, b);
        vec3 r = three(6u * (first + s) + 3u);
        for (int i = 0; i < 3 * TERMS; ++i) r[i % 3] -= colours[i] * b[i / 3];
        weights[lane()] += 0.5 * dot(r, r);
    }
    barrier();
    if (lane() > 0) return;
    for (int i = 1; i < LANES; ++i) weights[0] += weights[i];
    solutions[result + uint(RIGHT * RANK)] = weights[0];
}
