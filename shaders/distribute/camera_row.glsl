// A row of a camera's matrix times a point. Precise, with its order written out: all passes must project a point to the
// same bits, or a sample is taken in one and not in another; and a driver may sum a dot() as it likes.
float camera_row(vec4 row, vec3 world) {
    precise float sum = row.x * world.x + row.y * world.y + row.z * world.z + row.w;
    return sum;
}
