// What all passes over light field maps share. Maps, samples and tables that a pass only reads it fetches from buffer textures:
// loads from storage buffers take llvmpipe longer.
#include "model/vec3_element.glsl"
#include "optimize/problem_state.glsl"
#include "compute/problems.glsl"
layout(local_size_x = LANES) in;

// One buffer of whole numbers holds all that stays as it is; tables[] says where each table begins.
#define TABLE_VERTICES 0
#define TABLE_MAPS 1
#define TABLE_SITES 2         // [surface texels of all vertices] map of the vertex << 16 | texel of the map
#define TABLE_NEIGHBOURS 3    // [side][texel][2], then [view texel][2]: four of 16 bits, or NONE
#define TABLE_CELL_FIRST 4    // [vertex][view texel], and one more each: into TABLE_CELL_PAIRS
#define TABLE_CELL_PAIRS 5    // pairs of the vertex whose look-ups begin at a view texel
#define TABLE_PAIR_FIRST 6    // [pairs + 1] into TABLE_PAIR_GROUPS
#define TABLE_PAIR_GROUPS 7   // groups of samples that a pair sees, each 3 x group + corner
#define TABLE_TILES 8
#define TABLE_BLOCKS 9        // where the samples of LANES groups of a tile, or of LANES texels, begin
#define TABLE_TEXELS 10       // of tiles, those with most samples first: samples << 16 | texel of the tile
#define TABLES 11
#define NONE 0xffffu
uniform usamplerBuffer table;
uniform int tables[TABLES];
uniform int vertex_count;
uint at_table(int name, uint i) { return texelFetch(table, tables[name] + int(i)).r; }

uint lane() { return gl_LocalInvocationID.x; }
uint group_index() { return gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x; }

layout(std430) readonly buffer Numbers { float numbers[]; };  // [problem][NUMBER_COUNT], as ProblemState and Own list them
vec3 number_of(int number, uint vertex) {
    uint first = 3u * vertex * uint(NUMBER_COUNT) + uint(number);
    return vec3(numbers[first], numbers[first + uint(NUMBER_COUNT)], numbers[first + 2u * uint(NUMBER_COUNT)]);
}
// Whether one of the vertex's problems still runs.
bool is_active(uint vertex) { return any(equal(number_of(NUMBER_STATUS, vertex), vec3(STATUS_ACTIVE))); }

vec3 element_at(samplerBuffer vector, uint i) { return texelFetch(vector, int(i)).xyz; }

// The sum over the work group, always in the same order. All its invocations must call it: it holds barriers.
shared vec4 parts[LANES];
vec4 group_sum(vec4 mine) {
    barrier();  // whoever reads the last sum has done so
    parts[lane()] = mine;
    for (uint half_size = uint(LANES) / 2u; half_size > 0u; half_size /= 2u) {
        barrier();
        if (lane() < half_size) parts[lane()] += parts[lane() + half_size];
    }
    barrier();
    return parts[0];
}
vec3 group_sum(vec3 mine) { return group_sum(vec4(mine, 0.0)).xyz; }
vec3 group_max(vec3 mine) {
    barrier();
    parts[lane()] = vec4(mine, 0.0);
    for (uint half_size = uint(LANES) / 2u; half_size > 0u; half_size /= 2u) {
        barrier();
        if (lane() < half_size) parts[lane()] = max(parts[lane()], parts[lane() + half_size]);
    }
    barrier();
    return parts[0].xyz;
}
