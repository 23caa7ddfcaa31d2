// Light field maps in buffers. A work group is a vertex, whose three problems are side by side in a vec3; its invocations
// share its elements. compute/sample_store.h and compute/compute_engine.h say what the buffers hold.
#include "compute/tables.glsl"
layout(std430) buffer Problems { vec4 problems[]; };  // [vertex][OF_VERTEX]

struct Vertex {
    uint first;       // element of its first surface map's first texel and term, in all vectors
    uint view_first;  // element of its view map's
    uint ring, ring_end;
    uint pair, pair_end;
    uint site;  // of its first surface map's first texel
};
#define VERTEX_WORDS 7u
uint vertex_index() { return group_index(); }
vec3 number_of(int number) { return number_of(number, vertex_index()); }
bool is_active() { return vertex_index() < uint(vertex_count) && is_active(vertex_index()); }
// Whether one of the vertex's problems still runs or, having ended, may have a trial to take over.
bool is_alive() {
    return vertex_index() < uint(vertex_count) &&
           (is_active(vertex_index()) || any(notEqual(number_of(NUMBER_ACCEPTED), vec3(0.0))));
}
Vertex this_vertex() {
    uint i = vertex_index() * VERTEX_WORDS;
    return Vertex(at_table(TABLE_VERTICES, i), at_table(TABLE_VERTICES, i + 1u), at_table(TABLE_VERTICES, i + 2u),
                  at_table(TABLE_VERTICES, i + 3u), at_table(TABLE_VERTICES, i + 4u), at_table(TABLE_VERTICES, i + 5u),
                  at_table(TABLE_VERTICES, i + 6u));
}
#define OF_THIS_VERTEX(what) problems[vertex_index() * uint(OF_VERTEX) + uint(what)]

// Words of a surface map, which is that of a corner of a triangle.
#define MAP_FIRST 0      // element
#define MAP_CORNER 1     // 3 x tile + corner
#define MAP_NEIGHBOUR 2  // in TABLE_NEIGHBOURS
#define MAP_WORDS 3u
uint of_map(uint map, int what) { return at_table(TABLE_MAPS, map * MAP_WORDS + uint(what)); }
