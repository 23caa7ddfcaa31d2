#version 300 es
// Of every vertex the angle to the nearest photograph that shows it, seen from one camera: an entry of the table that it draws.
// variants: SEEN_ENTRIES=1,2
precision highp float;
precision highp int;
precision highp sampler2D;
#include "view/table.glsl"
#include "view/frame.glsl"
#include "view/photographs.glsl"
uniform sampler2D vertices;  // [2 vertex]: position; [2 vertex + 1]: normal
uniform int vertex_count;
out vec4 values;

void main() {
    int vertex = (int(gl_FragCoord.y) << TABLE_COLUMN_BITS) + int(gl_FragCoord.x);
    values = vec4(0.0);
    if (vertex < vertex_count) values.x = nearest_photograph(vertex, table_entry(vertices, 2 * vertex).xyz);
}
