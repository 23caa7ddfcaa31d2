// Where a tile's three vertices go in the layout. The hypotenuse runs half a texel beyond the diagonal cells' centres, so
// exactly the tile's texels are covered: the same ones in every pass.
invariant gl_Position;
vec4 cover_tile(ivec3 frame, int corner, vec2 layout_size) {
    vec2 to = vec2(corner == 1, corner == 2) * (float(SIDE) + 0.5);
    vec2 start = vec2(frame.xy) + (frame.z > 0 ? 0.0 : 1.0);
    precise vec2 at = (start + float(frame.z) * to) / layout_size * 2.0 - 1.0;
    return vec4(at, 0.0, 1.0);
}
