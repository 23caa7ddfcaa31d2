// Passes with one fragment per tile loop over its texels. Tiles lie as TilePlaces says, and those that
// were not drawn loop over nothing: a vector of lanes ends with its last one.
uniform usampler2D drawn;
uniform usampler2D tile_vertices;  // per tile: its triangle's vertices; the tile
int rows_to_visit() { return texelFetch(drawn, ivec2(gl_FragCoord.xy), 0).r != 0u ? SIDE : 0; }
