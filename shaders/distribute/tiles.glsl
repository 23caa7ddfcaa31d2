// The SLS layout of a triangle atlas: two tiles share one rectangle of n x (n+1) texels, the even tile upright, the odd
// one turned by half a turn. SIDE is n, RECTANGLES their number per row of the layout.
#ifndef SIDE
#define SIDE 8
#endif
#ifndef RECTANGLES
#define RECTANGLES 64
#endif
const int layout_width = SIDE * RECTANGLES;  // texels

// Cell (0, 0) of a tile of side `side` and the sign of its axes: place = xy + z * cell.
ivec3 tile_frame(int tile, int side) {
    int rectangle = tile >> 1;
    ivec2 corner = ivec2(rectangle % RECTANGLES, rectangle / RECTANGLES) * ivec2(side, side + 1);
    return (tile & 1) == 0 ? ivec3(corner, 1) : ivec3(corner + ivec2(side - 1, side), -1);
}

// The tile and cell that a place of the layout belongs to: xy the cell, z the tile.
ivec3 tile_at(ivec2 place) {
    ivec2 rectangle = place / ivec2(SIDE, SIDE + 1);
    ivec2 inside = place - rectangle * ivec2(SIDE, SIDE + 1);
    int tile = 2 * (rectangle.y * RECTANGLES + rectangle.x);
    bool even = inside.x + inside.y < SIDE;
    return even ? ivec3(inside, tile) : ivec3(ivec2(SIDE - 1, SIDE) - inside, tile + 1);
}

// Barycentric weights at a cell's centre; a diagonal cell's own centroid. Precise, for all passes find a texel's pixel by
// them.
vec3 cell_barycentric(ivec2 cell) {
    float centre = cell.x + cell.y == SIDE - 1 ? 1.0 / 3.0 : 0.5;
    precise vec2 b = (vec2(cell) + centre) / float(SIDE);
    precise float first = 1.0 - b.x - b.y;
    return vec3(first, b);
}
