#version 300 es
// The view maps of all vertices, looked up for one camera: h_k (shaders/model/lfm.glsl). An entry of the table that it draws is
// a vertex and a term, or what comes after its terms, the angle to the nearest photograph that shows it.
// variants: TERMS=1,3 MAPS=24 SEEN_ENTRIES=-,1 VERTEX_ENTRIES=4 NEAREST=-,1
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
#include "model/prelude.glsl"
#include "view/table.glsl"
#include "view/maps.glsl"
#include "view/frame.glsl"
#ifdef SEEN_ENTRIES
#include "view/photographs.glsl"
#endif
#include "model/lfm.glsl"
uniform sampler2DArray view_maps;
uniform sampler2D vertices;  // [2 vertex]: position; [2 vertex + 1]: normal
uniform int view_side, view_columns, vertex_count;
out vec4 values;

void main() {
    int entry = (int(gl_FragCoord.y) << TABLE_COLUMN_BITS) + int(gl_FragCoord.x);
    int vertex = entry / VERTEX_ENTRIES, k = entry % VERTEX_ENTRIES;
    values = vec4(0.0);
    if (vertex >= vertex_count) return;
    vec3 position = table_entry(vertices, 2 * vertex).xyz;
    if (k == TERMS) {
#ifdef SEEN_ENTRIES
        values.x = nearest_photograph(vertex, position);
#endif
        return;
    }
    mat3 frame = frame_of(table_entry(vertices, 2 * vertex + 1).xyz);
    vec2 coordinate = lfm_view_coordinate(to_local(frame, direction_to(eye, position)));
#ifdef NEAREST
    vec4 footprint = lfm_view_nearest(coordinate, float(view_side));
#else
    vec4 footprint = lfm_view_bilinear(coordinate, float(view_side));
#endif
    vec4 weights = lfm_view_weights(footprint);
    ivec2 place = ivec2(vertex % view_columns, vertex / view_columns) * view_side + ivec2(footprint.xy);
    int map = 3 * TERMS + k;
    values.rgb = weights.x * map_value(view_maps, map, place) + weights.y * map_value(view_maps, map, place + ivec2(1, 0)) +
                 weights.z * map_value(view_maps, map, place + ivec2(0, 1)) +
                 weights.w * map_value(view_maps, map, place + ivec2(1, 1));
}
