#version 450 core
// variants: LANES=8,64 RANK=1,10,28
// The normal equations of a view basis (model/view_basis.glsl), a texel for each work group: the z of least
//     sum over samples of w |y - z . phi|^2 + noise |z|^2,    phi_k = u_k . b,  y = colour - m . b.
// Samples come LANES at a time: an invocation finds phi and y of one, then adds to its own entries of the sums over all
// of them. The matrix has the right-hand sides as its last three rows, so that factoring it solves for them, too.
#include "model/prelude.glsl"
#include "model/view_basis.glsl"
#define COLUMNS (RANK + 3)
#define ENTRIES (COLUMNS * (COLUMNS + 1) / 2)
#define ENTRIES_EACH ((ENTRIES + LANES - 1) / LANES)
layout(local_size_x = LANES) in;
layout(std430) readonly buffer Texels { uvec4 texels[]; };         // where its samples begin; how many; its block
layout(std430) readonly buffer Samples { float samples[]; };       // [sample] direction, colour
layout(std430) readonly buffer Basis { float basis[]; };           // [block][VIEW_TERMS] of m, then of u: COLUMNS
layout(std430) writeonly buffer Solutions { float solutions[]; };  // [texel] z: [RANK][3]; 1/2 sum r^2
uniform int texel_count;
uniform float noise;
shared float columns[LANES][COLUMNS];  // phi, y
shared float weights[LANES];
shared float matrix[ENTRIES];  // lower triangle, row by row
shared float colours[3 * VIEW_TERMS];  // of the texel, as polynomials

int lane() { return int(gl_LocalInvocationIndex); }
int at(int row, int column) { return row * (row + 1) / 2 + column; }
vec3 three(uint first) { return vec3(samples[first], samples[first + 1u], samples[first + 2u]); }

void find_columns(uint block_first, uint sample_first) {
    vec3 direction = three(sample_first), colour = three(sample_first + 3u);
    ViewTerms b = view_terms(direction);
    weights[lane()] = view_weight(direction);
    for (int column = 0; column < COLUMNS; ++column) {
        float sum = 0.0;
        for (int i = 0; i < VIEW_TERMS; ++i) sum += basis[block_first + uint(i * COLUMNS + column)] * b.x[i];
        columns[lane()][column < 3 ? RANK + column : column - 3] = column < 3 ? colour[min(column, 2)] - sum : sum;
    }
}

void main() {
    uint texel = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    if (texel >= uint(texel_count)) return;
    uint first = 6u * texels[texel].x, count = texels[texel].y, block_first = texels[texel].z * uint(VIEW_TERMS * COLUMNS);
    ivec2 places[ENTRIES_EACH];
    float sums[ENTRIES_EACH];
    for (int i = 0; i < ENTRIES_EACH; ++i) {
        int entry = min(lane() + i * LANES, ENTRIES - 1);
        int row = int(0.5 * sqrt(float(8 * entry + 1)) - 0.49);  // whole + 0.01 at a row's first entry, less by 0.03 before it
        places[i] = ivec2(row, entry - at(row, 0));
        sums[i] = places[i].x == places[i].y ? noise : 0.0;
    }
    for (uint begin = 0u; begin < count; begin += uint(LANES)) {
        int here = int(min(uint(LANES), count - begin));
        barrier();
        if (lane() < here) find_columns(block_first, first + 6u * (begin + uint(lane())));
        barrier();
        for (int s = 0; s < here; ++s)
            for (int i = 0; i < ENTRIES_EACH; ++i)
                sums[i] += weights[s] * columns[s][places[i].x] * columns[s][places[i].y];
    }
    for (int i = 0; i < ENTRIES_EACH; ++i) matrix[min(lane() + i * LANES, ENTRIES - 1)] = sums[i];

    for (int k = 0; k < RANK; ++k) {  // Cholesky's decomposition, column by column
        barrier();
        float pivot = sqrt(matrix[at(k, k)]);
        barrier();
        for (int row = k + lane(); row < COLUMNS; row += LANES) matrix[at(row, k)] /= pivot;
        barrier();
        for (int i = 0; i < ENTRIES_EACH; ++i)
            if (places[i].y > k && lane() + i * LANES < ENTRIES)
                matrix[lane() + i * LANES] -= matrix[at(places[i].x, k)] * matrix[at(places[i].y, k)];
    }
    barrier();
    for (int c = lane(); c < 3; c += LANES)  // z in place of the right-hand sides
        for (int k = RANK - 1; k >= 0; --k) {
            float sum = matrix[at(RANK + c, k)];
            for (int j = k + 1; j < RANK; ++j) sum -= matrix[at(j, k)] * matrix[at(RANK + c, j)];
            matrix[at(RANK + c, k)] = sum / matrix[at(k, k)];
        }
    barrier();
    uint result = texel * uint(3 * RANK + 1);
    for (int i = lane(); i < 3 * RANK; i += LANES) solutions[result + uint(i)] = matrix[at(RANK + i % 3, i / 3)];
    for (int i = lane(); i < 3 * VIEW_TERMS; i += LANES) {
        uint row = block_first + uint(i / 3 * COLUMNS);
        float sum = basis[row + uint(i % 3)];
        for (int k = 0; k < RANK; ++k) sum += matrix[at(RANK + i % 3, k)] * basis[row + uint(3 + k)];
        colours[i] = sum;
    }
    barrier();
    weights[lane()] = 0.0;  // from here on the invocations' parts of the error
    for (uint s = uint(lane()); s < count; s += uint(LANES)) {
        ViewTerms b = view_terms(three(first + 6u * s));
        vec3 r = three(first + 6u * s + 3u);
        for (int i = 0; i < 3 * VIEW_TERMS; ++i) r[i % 3] -= colours[i] * b.x[i / 3];
        weights[lane()] += 0.5 * dot(r, r);
    }
    barrier();
    if (lane() > 0) return;
    for (int i = 1; i < LANES; ++i) weights[0] += weights[i];
    solutions[result + uint(3 * RANK)] = weights[0];
}
