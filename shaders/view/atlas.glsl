// Where the texels of a mesh's triangles are (geometry/atlas.h): two tiles share a rectangle, the second one turned.
uniform int largest_side, rectangles_per_row;

ivec2 rectangle_of(int triangle) {
    int rectangle = triangle / 2;
    return ivec2(rectangle % rectangles_per_row * largest_side, rectangle / rectangles_per_row * (largest_side + 1));
}
// From a cell of a tile to the place in the rectangle, and back.
ivec2 turned(int triangle, ivec2 cell) {
    return triangle % 2 == 0 ? cell : ivec2(largest_side - 1, largest_side) - cell;
}
