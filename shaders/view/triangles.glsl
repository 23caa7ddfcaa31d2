// The mesh's tables.
uniform sampler2D vertices;   // [2 vertex]: position; [2 vertex + 1]: normal
uniform sampler2D triangles;  // [2 triangle]: three vertices, the tile's side; [2 triangle + 1]: the triangles across the edges
                              // opposite to these vertices, or -1

ivec4 corners_of(int triangle) { return ivec4(table_entry(triangles, 2 * triangle) + 0.5); }
ivec3 across_of(int triangle) { return ivec3(floor(table_entry(triangles, 2 * triangle + 1).xyz + 0.5)); }
vec3 vertex_position(int vertex) { return table_entry(vertices, 2 * vertex).xyz; }
vec3 vertex_normal(int vertex) { return table_entry(vertices, 2 * vertex + 1).xyz; }
