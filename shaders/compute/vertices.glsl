// Light field maps in storage buffers. A work group is a vertex, whose three problems stand side by side in a vec3;
// its invocations share its elements, and add up what they found always in the same order. compute/sample_store.h and
// compute/compute_engine.h say what the buffers hold.
#include "model/vec3_element.glsl"
#include "optimize/problem_state.glsl"
#include "compute/problems.glsl"
layout(local_size_x = LANES) in;

// Whatever a pass only reads it fetches from buffer textures, which every device reads best: loads from storage buffers take
// llvmpipe several times as long. One buffer of whole numbers holds all that stays as it is; tables[] says where each table begins.
#define TABLE_VERTICES 0
#define TABLE_MAPS 1
#define TABLE_SITES 2               // [surface texels of all vertices] map of the vertex << 16 | texel of the map
#define TABLE_NEIGHBOURS 3          // [side][texel][2], then [view texel][2]: four of 16 bits, or NONE
#define TABLE_CELL_FIRST 4          // [vertex][view texel], and one more each: into cell_pairs
#define TABLE_CELL_PAIRS 5          // pairs of the vertex whose look-ups begin at a view texel
#define TABLE_GROUPS_OF_IMAGES 6    // [tile][image] 16 bits: group in the tile, or NONE
#define TABLE_PAIRS_OF_GROUPS 7     // [map][group in its tile] 16 bits: pair of its vertex
#define TABLE_GROUP_FIRST 8         // [groups + 1] into samples_by_image
#define TABLE_TEXEL_FIRST 9         // [texels of tiles + 1] into samples_by_texel
#define TABLE_TARGET_WEIGHTS 10     // [side][corner][texel] float: Lambda times the targets' scale
#define TABLES 11
#define NONE 0xffffu
uniform usamplerBuffer table;
uniform int tables[TABLES];
uniform int vertex_count;

uint at_table(int name, uint i) { return texelFetch(table, tables[name] + int(i)).r; }
uint half_at_table(int name, uint i) { return (at_table(name, i / 2u) >> (16u * (i & 1u))) & 0xffffu; }

struct Vertex {
    uint first;       // element of its first surface map's first texel and term, in all vectors
    uint view_first;  // element of its view map's
    uint ring, ring_end;
    uint pair, pair_end;
    uint site;  // of its first surface map's first texel
};
#define VERTEX_WORDS 7u
layout(std430) readonly buffer Numbers { float numbers[]; };  // [problem][NUMBER_COUNT], as ProblemState and Own list them

layout(std430) buffer Problems { vec4 problems[]; };  // [vertex][OF_VERTEX]

uint lane() { return gl_LocalInvocationID.x; }
uint vertex_index() { return gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x; }

vec3 number_of(int number) {
    uint first = 3u * vertex_index() * uint(NUMBER_COUNT) + uint(number);
    return vec3(numbers[first], numbers[first + uint(NUMBER_COUNT)], numbers[first + 2u * uint(NUMBER_COUNT)]);
}
Vertex this_vertex() {
    uint i = vertex_index() * VERTEX_WORDS;
    return Vertex(at_table(TABLE_VERTICES, i), at_table(TABLE_VERTICES, i + 1u), at_table(TABLE_VERTICES, i + 2u),
                  at_table(TABLE_VERTICES, i + 3u), at_table(TABLE_VERTICES, i + 4u), at_table(TABLE_VERTICES, i + 5u),
                  at_table(TABLE_VERTICES, i + 6u));
}
#define OF_THIS_VERTEX(what) problems[vertex_index() * uint(OF_VERTEX) + uint(what)]
// Whether one of the vertex's problems still runs; or, once it has ended, may have a trial to take over.
bool is_active() { return vertex_index() < uint(vertex_count) && any(equal(number_of(NUMBER_STATUS), vec3(STATUS_ACTIVE))); }
bool is_alive() {
    return vertex_index() < uint(vertex_count) &&
           (any(equal(number_of(NUMBER_STATUS), vec3(STATUS_ACTIVE))) ||
            any(notEqual(number_of(NUMBER_ACCEPTED), vec3(0.0))));
}

// The sum over the work group, for its first invocation. Of all of them, and of none else: it holds barriers.
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
