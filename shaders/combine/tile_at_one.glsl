// Passes with one fragment per tile loop over its texels. In the layout of tiles of side 1 the even tile stands on an
// even row. Tiles that were not drawn loop over nothing: a vector of lanes ends with its last one.
layout(binding = 8) uniform sampler2D drawn;
int whole_tile() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    return 2 * ((at.y >> 1) * RECTANGLES + at.x) + (at.y & 1);
}
int rows_to_visit() { return texelFetch(drawn, ivec2(gl_FragCoord.xy), 0).r > 0.0 ? SIDE : 0; }
